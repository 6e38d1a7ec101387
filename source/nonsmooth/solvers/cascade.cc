#include "augmented_lagrangian.h"
#include "gathered.h"

#include "linear_algebra/factor_limits.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** The method of multipliers for bodies apart, of all ranks on one. */
    template <int dim>
    class Multipliers final : public NonsmoothSolver<dim>
    {
    public:
      SolverReport solve(const OneStepProblem<dim> &problem,
                         DelassusOperator<dim> &delassus,
                         const double energy_scale,
                         const SolverControl &control,
                         std::vector<double> &impulse,
                         LawEvaluation<dim> &evaluation) override
      {
        SolverReport report;
        if (delassus.communicator().size() == 1) {
          report = method_.solve(problem, delassus, energy_scale, control,
                                 impulse, evaluation);
          evaluation.update(impulse);
        } else {
          if (!gathered_)
            gathered_ = std::make_unique<Gathered<dim>>(delassus);
          solve_gathered(*gathered_, problem, delassus, energy_scale, control,
                         impulse, evaluation, report,
                         [&](const auto &whole, auto &bodies, auto &laws,
                             auto &all, auto &part) {
                           laws.update(all);
                           part = method_.solve(whole, bodies, energy_scale,
                                                control, all, laws);
                         });
        }
        report.residual = evaluation.error;
        report.converged = evaluation.error <= control.tolerance;
        return report;
      }

    private:
      std::unique_ptr<Gathered<dim>> gathered_; // before what refers to it
      AugmentedLagrangian<dim> method_;
    };

    /**
     * One solver after the other until the natural map is small: Newton's
     * method on the dual problem (with its sweeps of Gauss-Seidel), then
     * interior points where points may touch. At long steps, where Newton's
     * method needs a factor of all bodies in every iteration and Coulomb
     * friction makes it cycle, the interior points come first; without
     * friction, after a few steps of Newton's, which are enough where few
     * contacts change. Last the method of multipliers in the velocities, which
     * knows nothing of W: where W is singular, as round a node that four faces
     * share, the others may not reach the tolerance. Every hand-over is in the
     * report. Steps in which points
     * soften are not handed over: a shorter step is their cure, until four cuts
     * have shown that it is none.
     */
    template <int dim>
    class Cascade final : public NonsmoothSolver<dim>
    {
    public:
      Cascade() : newton_(SolverRegistry<dim>::instance().create("dual newton"))
      {
      }

      SolverReport solve(const OneStepProblem<dim> &problem,
                         DelassusOperator<dim> &delassus,
                         const double energy_scale,
                         const SolverControl &control,
                         std::vector<double> &impulse,
                         LawEvaluation<dim> &evaluation) override
      {
        // the interior points know the bodies' own matrices only
        const Communicator &all = delassus.communicator();
        if (dynamic_cast<VelocitySolver *>(&delassus))
          return solve_joined(problem, delassus, energy_scale, control, impulse,
                              evaluation);
        if (!delassus.bodies_are_apart())
          return newton_->solve(problem, delassus, energy_scale, control,
                                impulse, evaluation);
        const bool touches = all.any(may_touch(problem));
        if (touches && !path_)
          path_ = SolverRegistry<dim>::instance().create("interior point");
        const bool rubs = touches && all.any(may_rub(problem)),
                   lasts = touches && is_long(problem, delassus);
        auto *first = newton_.get(), *second = path_.get();
        const char *second_name = "interior point";
        if (rubs && lasts) {
          std::swap(first, second);
          second_name = "dual newton";
        }
        // a Newton step costs such a factor here, as one of the path does
        const auto n = all.sum_integer(delassus.bodies().n_dofs());
        const bool brief =
            lasts && !rubs && static_cast<long long>(n) <= largest_factor<dim>;
        SolverControl part = control;
        if (brief)
          part.maximum_iterations = std::min(part.iterations_or(200), 10u);
        const std::vector<double> start(impulse);
        SolverReport report = first->solve(problem, delassus, energy_scale,
                                           part, impulse, evaluation);
        const auto go_on = [&](NonsmoothSolver<dim> &solver, const char *name,
                               const bool from_start) {
          const std::vector<double> best(impulse);
          if (from_start)
            impulse = start;
          add(solver.solve(problem, delassus, energy_scale, control, impulse,
                           evaluation),
              name, report);
          if (evaluation.error > report.residual) {
            impulse = best;
            evaluation.update(impulse);
          }
          report.residual = evaluation.error;
          report.converged = report.residual <= control.tolerance;
        };
        const bool early =
            control.idle_rounds < (SolverControl().idle_rounds << 4);
        if (!report.converged && early &&
            all.any(softens(problem, evaluation))) {
          if (brief)
            go_on(*first, "dual newton", false);
          return report;
        }
        if (!report.converged && touches)
          go_on(*second, second_name, true);
        if (!report.converged && brief)
          go_on(*first, "dual newton", false);
        if (!report.converged)
          go_on(apart_, "multipliers", true);
        return report;
      }

      void serialize(Archive &archive) override
      {
        if (!path_)
          path_ = SolverRegistry<dim>::instance().create("interior point");
        path_->serialize(archive);
      }

    private:
      /** Of bodies that share nodes. */
      SolverReport solve_joined(const OneStepProblem<dim> &problem,
                                DelassusOperator<dim> &delassus,
                                const double energy_scale,
                                const SolverControl &control,
                                std::vector<double> &impulse,
                                LawEvaluation<dim> &evaluation)
      {
        const std::vector<double> start(impulse);
        SolverReport report = joined_.solve(problem, delassus, energy_scale,
                                            control, impulse, evaluation);
        // others know no motion of nodes
        if (report.converged || problem.free_motion != FreeVelocity::known)
          return report;
        const std::vector<double> best(impulse);
        const double error = evaluation.error;
        impulse = start;
        add(newton_->solve(problem, delassus, energy_scale, control, impulse,
                           evaluation),
            "dual newton", report);
        if (evaluation.error > error) {
          impulse = best;
          evaluation.update(impulse);
        }
        report.residual = evaluation.error;
        report.converged = report.residual <= control.tolerance;
        return report;
      }

      /** What @p next did goes into @p report. */
      static void add(const SolverReport &next, const char *name,
                      SolverReport &report)
      {
        report.switches.push_back(name);
        report.add_work(next);
      }

      static bool may_touch(const OneStepProblem<dim> &problem)
      {
        return std::any_of(problem.contact.begin(), problem.contact.end(),
                           [](const auto contact) { return contact != 0; });
      }

      static bool may_rub(const OneStepProblem<dim> &problem)
      {
        for (std::size_t i = 0; i < problem.n_points; ++i)
          if (problem.contact[i] && problem.kind[i] != PointKind::prescribed &&
              problem.interactions[problem.interaction[i]].friction > 0.)
            return true;
        return false;
      }

      /** Damage grows, or has begun and not come to its end. */
      static bool softens(const OneStepProblem<dim> &problem,
                          const LawEvaluation<dim> &evaluation)
      {
        for (std::size_t i = 0; i < problem.n_points; ++i) {
          if (evaluation.solutions[i].damages)
            return true;
          if (problem.kind[i] != PointKind::cohesive)
            continue;
          const auto &interaction =
              problem.interactions[problem.interaction[i]];
          const Reach history{problem.opening_max[i],
                              problem.slip_max.empty() ? 0.
                                                       : problem.slip_max[i]};
          if (past_peak(*interaction.law, problem.opening_factor[i], history))
            return true;
        }
        return false;
      }

      /**
       * The bodies' stiffness, h^2 theta^2 K, is far more than their mass: on
       * the diagonal of the bodies, in the mean.
       */
      static bool is_long(const OneStepProblem<dim> &problem,
                          const DelassusOperator<dim> &delassus)
      {
        const double theta = delassus.bulk_theta();
        const double factor =
            problem.time_step * problem.time_step * theta * theta;
        std::vector<double> ratio;
        unsigned long long count = 0;
        for (const auto &body : delassus.bodies().classes)
          if (!body.rigid)
            for (unsigned int k = 0; k < body.n_dofs; ++k) {
              ratio.push_back(factor * body.stiffness(k, k) / body.mass(k, k) *
                              double(body.bodies.size()));
              count += body.bodies.size();
            }
        count = delassus.communicator().sum_integer(count);
        return count > 0 &&
               delassus.communicator().sum(ratio) > 50. * double(count);
      }

      std::unique_ptr<NonsmoothSolver<dim>> newton_, path_;
      AugmentedLagrangian<dim> joined_; ///< of bodies that share nodes
      Multipliers<dim> apart_;          ///< and of others
    };

    using Cascade2 = Cascade<2>;
    using Cascade3 = Cascade<3>;
    NSFD_REGISTER(SolverRegistry<2>, Cascade2, "cascade",
                  "dual newton, then interior point where it fails on contact; "
                  "at long steps the other way round; then multipliers");
    NSFD_REGISTER(SolverRegistry<3>, Cascade3, "cascade",
                  "dual newton, then interior point where it fails on contact; "
                  "at long steps the other way round; then multipliers");
  } // namespace
} // namespace nsfd
