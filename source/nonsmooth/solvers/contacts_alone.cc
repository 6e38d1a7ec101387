#include "nsfd/nonsmooth/solver.h"
#include "nsfd/stored/contact_solver.h"

#include <algorithm>
#include <map>

namespace nsfd
{
  namespace
  {
    constexpr unsigned int none = ~0u;

    /**
     * Steps in which nothing but contact and friction acts, as between rigid
     * bodies: the Coulomb problem itself, its matrix assembled body by body,
     * for the chain of solvers that knows nothing of bodies. Rows of walls and
     * heaps depend on each other; that chain is made for it.
     */
    template <int dim>
    class ContactsAlone final : public NonsmoothSolver<dim>
    {
    public:
      SolverReport solve(const OneStepProblem<dim> &problem,
                         Dynamics<dim> &dynamics, const double energy_scale,
                         const SolverControl &control,
                         std::vector<double> &impulse,
                         LawEvaluation<dim> &evaluation) override
      {
        SolverReport report;
        const Communicator &all = dynamics.communicator();
        if (all.any(!applies(problem, dynamics)))
          return go_on(problem, dynamics, energy_scale, control, impulse,
                       evaluation, report);
        evaluation.update(impulse);
        double goal = control.tolerance / 3.;
        for (unsigned int round = 0;
             evaluation.error > control.tolerance && round < 3; ++round) {
          if (round == 0)
            assemble(problem, dynamics);
          solve_contacts(goal, impulse, report);
          evaluation.update(impulse);
          goal /= 30.; // the measures of the two differ
        }
        report.residual = evaluation.error;
        report.converged = report.residual <= control.tolerance;
        if (report.converged)
          return report;
        return go_on(problem, dynamics, energy_scale, control, impulse,
                     evaluation, report);
      }

    private:
      /** No springs, joints or motions, and no lift by sliding. */
      static bool applies(const OneStepProblem<dim> &problem,
                          const Dynamics<dim> &dynamics)
      {
        if (!problem.dilatancy.empty() || !dynamics.bodies_are_apart() ||
            !dynamics.points().neighbors.empty())
          return false;
        for (std::size_t i = 0; i < problem.n_points; ++i)
          if (problem.kind[i] != PointKind::free)
            return false;
        return true;
      }

      SolverReport go_on(const OneStepProblem<dim> &problem,
                         Dynamics<dim> &dynamics, const double energy_scale,
                         const SolverControl &control,
                         std::vector<double> &impulse,
                         LawEvaluation<dim> &evaluation,
                         SolverReport report) const
      {
        const auto chain = SolverRegistry<dim>::instance().create("chain");
        const SolverReport next = chain->solve(
            problem, dynamics, energy_scale, control, impulse, evaluation);
        report.switches.push_back("chain");
        report.go_on_with(next);
        return report;
      }

      /** U = W P + U_free of the points that may touch, in their frames. */
      void assemble(const OneStepProblem<dim> &problem,
                    const Dynamics<dim> &dynamics)
      {
        points_.clear();
        std::vector<unsigned int> number(problem.n_points + 1, none);
        contact_ = ContactProblem();
        contact_.dimension = dim;
        for (std::size_t i = 0; i < problem.n_points; ++i)
          if (problem.contact[i]) {
            number[i] = unsigned(points_.size());
            points_.push_back(i);
            contact_.friction.push_back(
                problem.interactions[problem.interaction[i]].friction);
            for (unsigned int c = 0; c < dim; ++c)
              contact_.q.push_back(problem.free_velocity[i * dim + c] +
                                   (c == 0
                                        ? -problem.target[i]
                                        : problem.sliding_offset[i * dim + c]));
          }
        std::vector<std::map<unsigned int, Square>> rows(points_.size());
        const Bodies &bodies = dynamics.bodies();
        const auto &frame = dynamics.points().frame;
        for (std::size_t b = 0; b < bodies.size(); ++b) {
          const Block &W =
              dynamics.class_blocks()[bodies.class_of[b]].delassus;
          for (std::size_t s = bodies.first_slot[b];
               s < bodies.first_slot[b + 1]; ++s)
            for (std::size_t t = bodies.first_slot[b];
                 t < bodies.first_slot[b + 1]; ++t) {
              const std::size_t i = bodies.slot_point[s],
                                j = bodies.slot_point[t];
              if (number[i] != none && number[j] != none)
                add(W, unsigned(s - bodies.first_slot[b]),
                    unsigned(t - bodies.first_slot[b]),
                    double(bodies.slot_sign[s]) * bodies.slot_sign[t],
                    &frame[i * dim * dim], &frame[j * dim * dim],
                    rows[number[i]][number[j]]);
            }
        }
        set_matrix(rows);
      }

      using Square = std::array<double, dim * dim>;

      static void add(const Block &W, const unsigned int s,
                      const unsigned int t, const double sign,
                      const double *Q_i, const double *Q_j, Square &sum)
      {
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            for (unsigned int c = 0; c < dim; ++c)
              for (unsigned int d = 0; d < dim; ++d)
                sum[a * dim + b] += sign * Q_i[a * dim + c] *
                                    W(s * dim + c, t * dim + d) *
                                    Q_j[b * dim + d];
      }

      /** Over the mean of its diagonal: its measure compares r with u. */
      void set_matrix(const std::vector<std::map<unsigned int, Square>> &rows)
      {
        unit_ = 0.;
        for (std::size_t i = 0; i < rows.size(); ++i)
          for (unsigned int c = 0; c < dim; ++c)
            unit_ += rows[i].at(unsigned(i))[c * dim + c] /
                     double(rows.size() * dim);
        contact_.row_start.assign(1, 0);
        for (const auto &row : rows)
          for (unsigned int c = 0; c < dim; ++c) {
            for (const auto &[j, block] : row)
              for (unsigned int d = 0; d < dim; ++d) {
                contact_.column.push_back(int(j * dim + d));
                contact_.value.push_back(block[c * dim + d] / unit_);
              }
            contact_.row_start.push_back(int(contact_.column.size()));
          }
      }

      void solve_contacts(const double tolerance, std::vector<double> &impulse,
                          SolverReport &report) const
      {
        std::vector<double> r(contact_.q.size());
        for (std::size_t k = 0; k < r.size(); ++k)
          r[k] = impulse[points_[k / dim] * dim + k % dim] * unit_;
        ContactControl control;
        control.tolerance = tolerance;
        const ContactReport part =
            solve_contact_problem(contact_, "auto", control, r);
        report.newton += part.factorisations;
        report.sweeps += part.iterations;
        report.krylov += part.products;
        std::fill(impulse.begin(), impulse.end(), 0.);
        for (std::size_t k = 0; k < r.size(); ++k)
          impulse[points_[k / dim] * dim + k % dim] = r[k] / unit_;
      }

      ContactProblem contact_;
      std::vector<std::size_t> points_;
      double unit_ = 1.;
    };

    using ContactsAlone2 = ContactsAlone<2>;
    using ContactsAlone3 = ContactsAlone<3>;
    NSFD_REGISTER(SolverRegistry<2>, ContactsAlone2, "contacts alone",
                  "contact and friction of rigid bodies, by the solvers of "
                  "stored problems; the chain where more acts");
    NSFD_REGISTER(SolverRegistry<3>, ContactsAlone3, "contacts alone",
                  "contact and friction of rigid bodies, by the solvers of "
                  "stored problems; the chain where more acts");
  } // namespace
} // namespace nsfd
