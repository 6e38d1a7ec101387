// What all methods for an assembled W have in common.
#include "session.h"

namespace nsfd
{
  namespace
  {
    using stored::Session;

    bool is_zero(const std::vector<double> &x)
    {
      return std::all_of(x.begin(), x.end(),
                         [](const double value) { return value == 0.; });
    }

    /** The largest approach velocity in units of the largest |q|. */
    double penetration(const std::vector<double> &q,
                       const std::vector<double> &u, const unsigned int d)
    {
      double deepest = 0., largest = 0.;
      for (std::size_t j = 0; j < u.size(); j += d)
        deepest = std::max(deepest, -u[j]);
      for (const double value : q)
        largest = std::max(largest, std::abs(value));
      return deepest > 0. ? deepest / largest : 0.;
    }

    template <int d>
    void run(const ContactMethod method, Session<d> &s,
             const SolverControl &control)
    {
      switch (method) {
      case ContactMethod::automatic:
        automatic(s, control.attempts);
        return;
      case ContactMethod::gauss_seidel:
        gauss_seidel(s, control.iterations_or(10000));
        return;
      case ContactMethod::admm:
        admm(s, control.iterations_or(10000));
        return;
      case ContactMethod::projected_gradient:
        projected_gradient(s, control.iterations_or(10000));
        return;
      default:
        break;
      }
      // the others start near the solution: a few sweeps
      gauss_seidel(s, 10);
      if (method == ContactMethod::interior_point)
        interior_point(s, control.iterations_or(150));
      else if (method == ContactMethod::proximal)
        proximal(s, control.iterations_or(100));
      else {
        stored::NewtonSettings settings;
        settings.limit = control.iterations_or(100);
        settings.idle = settings.limit;
        newton(s, settings);
      }
    }

    template <int d>
    SolverReport run(const ContactMethod method, const ContactProblem &problem,
                     const SolverControl &control, std::vector<double> &impulse)
    {
      Session<d> s(problem, control.tolerance);
      if (!is_zero(impulse)) {
        for (std::size_t j = 0; j < impulse.size(); ++j)
          s.r[j] = impulse[j] / s.problem.impulse_unit;
        s.judge();
        if (std::isnan(s.error)) // no start at all
          s.restore_best();
      }
      if (!s.solved()) {
        run(method, s, control);
        s.restore_best();
      }
      for (std::size_t j = 0; j < impulse.size(); ++j)
        impulse[j] = s.r[j] * s.problem.impulse_unit;
      SolverReport report;
      report.residual = s.error;
      report.converged = s.solved();
      report.solver = s.finisher;
      report.iterations = s.iterations;
      report.products = s.products;
      report.factorisations = s.factorisations;
      report.switches = s.switches;
      report.attempts = s.attempts;
      report.best_attempt = s.best_attempt;
      return report;
    }
  } // namespace

  template <ContactMethod method>
  SolverReport
  AssembledMethod<method>::solve_assembled(const ContactProblem &problem,
                                           const SolverControl &control,
                                           std::vector<double> &impulse) const
  {
    return problem.dimension == 2 ? run<2>(method, problem, control, impulse)
                                  : run<3>(method, problem, control, impulse);
  }

  SolverReport solve_contact_problem(const ContactProblem &problem,
                                     const ContactSolver &solver,
                                     const std::string &name,
                                     const SolverControl &control,
                                     std::vector<double> &impulse)
  {
    if (impulse.size() != problem.n_rows())
      impulse.assign(problem.n_rows(), 0.);
    SolverReport report;
    std::vector<double> u;
    const auto judge = [&] {
      relative_velocity(problem, impulse, u);
      report.residual = natural_map_error(problem, impulse, u);
      report.converged = report.residual <= control.tolerance;
    };
    // nothing to do, found out without a product
    if (is_zero(impulse))
      judge();
    if (!report.converged) {
      report = solver.solve_assembled(problem, control, impulse);
      judge();
    }
    report.penetration = penetration(problem.q, u, problem.dimension);
    if (report.solver.empty())
      report.solver = report.iterations > 0 ? name : "none";
    return report;
  }

  template class AssembledMethod<ContactMethod::automatic>;
  template class AssembledMethod<ContactMethod::gauss_seidel>;
  template class AssembledMethod<ContactMethod::newton>;
  template class AssembledMethod<ContactMethod::proximal>;
  template class AssembledMethod<ContactMethod::interior_point>;
  template class AssembledMethod<ContactMethod::admm>;
  template class AssembledMethod<ContactMethod::projected_gradient>;
} // namespace nsfd
