// The solvers of stored problems by name.
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

    template <int d, typename Method>
    ContactReport run(const ContactProblem &problem,
                      const ContactControl &control,
                      std::vector<double> &impulse)
    {
      Session<d> s(problem, control.tolerance);
      if (!is_zero(impulse)) {
        for (std::size_t j = 0; j < impulse.size(); ++j)
          s.r[j] = impulse[j] / s.problem.impulse_unit;
        s.judge();
      }
      if (!s.solved())
        Method::run(s, control.maximum_iterations);
      for (std::size_t j = 0; j < impulse.size(); ++j)
        impulse[j] = s.r[j] * s.problem.impulse_unit;
      ContactReport report;
      report.error = s.error;
      report.solver = s.finisher;
      report.iterations = s.iterations;
      report.products = s.products;
      report.factorisations = s.factorisations;
      report.switches = s.switches;
      return report;
    }

    /** @tparam Method has `run(session, limit)`, a limit of 0 is its own */
    template <typename Method>
    class Solver final : public ContactSolver
    {
    public:
      ContactReport solve(const ContactProblem &problem,
                          const ContactControl &control,
                          std::vector<double> &impulse) const override
      {
        return problem.dimension == 2
                   ? run<2, Method>(problem, control, impulse)
                   : run<3, Method>(problem, control, impulse);
      }
    };

    struct Automatic {
      template <int d>
      static void run(Session<d> &s, unsigned int)
      {
        automatic(s);
      }
    };
    struct GaussSeidel {
      template <int d>
      static void run(Session<d> &s, const unsigned int limit)
      {
        gauss_seidel(s, limit ? limit : 10000);
      }
    };

    // Newton's method starts near the solution: a few sweeps
    struct DualNewton {
      template <int d>
      static void run(Session<d> &s, const unsigned int limit)
      {
        gauss_seidel(s, 10);
        stored::NewtonSettings settings;
        settings.limit = limit ? limit : 100;
        settings.idle = settings.limit;
        newton(s, settings);
      }
    };
    struct Proximal {
      template <int d>
      static void run(Session<d> &s, const unsigned int limit)
      {
        gauss_seidel(s, 10);
        proximal(s, limit ? limit : 100);
      }
    };
    struct InteriorPoint {
      template <int d>
      static void run(Session<d> &s, const unsigned int limit)
      {
        gauss_seidel(s, 10);
        interior_point(s, limit ? limit : 150);
      }
    };
    struct Admm {
      template <int d>
      static void run(Session<d> &s, const unsigned int limit)
      {
        admm(s, limit ? limit : 10000);
      }
    };
    struct ProjectedGradient {
      template <int d>
      static void run(Session<d> &s, const unsigned int limit)
      {
        projected_gradient(s, limit ? limit : 10000);
      }
    };

    NSFD_REGISTER(ContactSolverRegistry, Solver<Automatic>, "auto",
                  "a chain of the others, each as long as it promises to pay");
    NSFD_REGISTER(ContactSolverRegistry, Solver<GaussSeidel>, "gauss seidel",
                  "sweeps of exact local solves");
    NSFD_REGISTER(ContactSolverRegistry, Solver<DualNewton>, "dual newton",
                  "semismooth Newton on the impulses, near minimum-norm steps");
    NSFD_REGISTER(ContactSolverRegistry, Solver<Proximal>, "proximal",
                  "proximal point around Newton");
    NSFD_REGISTER(ContactSolverRegistry, Solver<InteriorPoint>,
                  "interior point", "primal-dual, the friction law in it");
    NSFD_REGISTER(ContactSolverRegistry, Solver<Admm>, "admm",
                  "alternating directions with balanced penalty");
    NSFD_REGISTER(ContactSolverRegistry, Solver<ProjectedGradient>,
                  "projected gradient", "accelerated, with restarts");
  } // namespace

  ContactReport solve_contact_problem(const ContactProblem &problem,
                                      const std::string &solver,
                                      const ContactControl &control,
                                      std::vector<double> &impulse)
  {
    if (impulse.size() != problem.n_rows())
      impulse.assign(problem.n_rows(), 0.);
    ContactReport report;
    std::vector<double> u;
    const auto judge = [&] {
      relative_velocity(problem, impulse, u);
      report.error = natural_map_error(problem, impulse, u);
      report.solved = report.error <= control.tolerance;
    };
    // nothing to do, found out without a product
    if (is_zero(impulse))
      judge();
    if (!report.solved) {
      report = ContactSolverRegistry::instance().create(solver)->solve(
          problem, control, impulse);
      judge();
    }
    report.penetration = penetration(problem.q, u, problem.dimension);
    if (report.solver.empty())
      report.solver = report.iterations > 0 ? solver : "none";
    return report;
  }
} // namespace nsfd
