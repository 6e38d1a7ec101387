#include "augmented_lagrangian.h"
#include "tied_nodes.h"

#include "linear_algebra/factor_limits.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /**
     * One solver after the other until the natural map is small: Newton's
     * method on the dual problem (with its sweeps of Gauss-Seidel), then
     * interior points where points may touch. At long steps, where Newton's
     * method needs a factor of all bodies in every iteration and Coulomb
     * friction makes it cycle, the interior points come first; without
     * friction, after a few steps of Newton's, which are enough where few
     * contacts change. In large motions last the method of multipliers in the
     * velocities, which
     * knows nothing of W: where W is singular, as round a node that four faces
     * share, the others may not reach the tolerance. It comes first where most
     * points are joints of deformable bodies, whose nodes it takes for one, and
     * no factor of a former problem is of use; and on few bodies with laws,
     * where it solves steps that the others would have to cut.
     * Every hand-over is in the report. Steps in which points soften are not
     * handed over: a shorter step is their cure, until four cuts have shown
     * that it is none.
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
        if (dynamic_cast<VelocitySolver *>(&delassus))
          return solve_joined(problem, delassus, energy_scale, control, impulse,
                              evaluation);
        if (!delassus.bodies_are_apart())
          return newton_->solve(problem, delassus, energy_scale, control,
                                impulse, evaluation);
        const auto others = [&](const bool end_with_multipliers) {
          return solve_others(problem, delassus, energy_scale, control,
                              end_with_multipliers, impulse, evaluation);
        };
        if (!control.bodies_change || !suits_multipliers(problem, delassus))
          return others(control.bodies_change);
        const std::vector<double> start(impulse);
        SolverReport report = multipliers().solve(
            problem, delassus, energy_scale, control, impulse, evaluation);
        if (!report.converged)
          hand_over([&] { return others(false); }, "dual newton", &start,
                    control, impulse, evaluation, report);
        return report;
      }

      void serialize(Archive &archive) override
      {
        if (!path_)
          path_ = SolverRegistry<dim>::instance().create("interior point");
        path_->serialize(archive);
      }

    private:
      SolverReport solve_others(const OneStepProblem<dim> &problem,
                                DelassusOperator<dim> &delassus,
                                const double energy_scale,
                                const SolverControl &control,
                                const bool end_with_multipliers,
                                std::vector<double> &impulse,
                                LawEvaluation<dim> &evaluation)
      {
        const Communicator &all = delassus.communicator();
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
          hand_over(
              [&] {
                return solver.solve(problem, delassus, energy_scale, control,
                                    impulse, evaluation);
              },
              name, from_start ? &start : nullptr, control, impulse, evaluation,
              report);
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
        if (!report.converged && end_with_multipliers)
          go_on(multipliers(), "multipliers", true);
        return report;
      }

      NonsmoothSolver<dim> &multipliers()
      {
        if (!last_)
          last_ = SolverRegistry<dim>::instance().create("multipliers");
        return *last_;
      }

      /**
       * Most points are joints of deformable bodies, which have a factor once
       * the joints are gone; or some have laws, and a factor of all bodies, in
       * each of the many Newton steps that softening takes, is little work.
       * Collective.
       */
      static bool suits_multipliers(const OneStepProblem<dim> &problem,
                                    const DelassusOperator<dim> &delassus)
      {
        const auto &points = delassus.points();
        const auto &bodies = delassus.bodies();
        const std::size_t n = owned_acting(problem);
        unsigned long long n_held = 0;
        bool has_laws = false;
        for (std::size_t a = 0; a < n; ++a) {
          const std::size_t i = problem.acting[a];
          bool deforms = true;
          for (const int b : points.faces[points.face_of[i]].bodies)
            if (b >= 0)
              deforms = deforms &&
                        !bodies.classes[bodies.class_of[std::size_t(b)]].rigid;
          n_held += deforms && is_held(problem, i);
          has_laws |= deforms && (problem.kind[i] == PointKind::cohesive ||
                                  problem.kind[i] == PointKind::rigid);
        }
        const Communicator &all = delassus.communicator();
        const auto n_dofs = all.sum_integer(bodies.n_dofs());
        const bool joins = 2 * all.sum_integer(n_held) > all.sum_integer(n);
        // of 2^dim cells round a node one unknown is left
        return (all.any(has_laws) && n_dofs <= few_unknowns) ||
               (joins && n_dofs <= (10ull << dim) * largest_factor<dim>);
      }

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
        hand_over(
            [&] {
              return newton_->solve(problem, delassus, energy_scale, control,
                                    impulse, evaluation);
            },
            "dual newton", &start, control, impulse, evaluation, report);
        return report;
      }

      /**
       * @p solve, at @p start if there is one, after what @p report has come
       * to; the better one of both answers is kept, and the work of both.
       */
      template <typename Solve>
      static void
      hand_over(const Solve &solve, const char *name,
                const std::vector<double> *start, const SolverControl &control,
                std::vector<double> &impulse, LawEvaluation<dim> &evaluation,
                SolverReport &report)
      {
        const std::vector<double> best(impulse);
        if (start)
          impulse = *start;
        const SolverReport next = solve();
        report.switches.push_back(name);
        report.add_work(next);
        if (evaluation.error > report.residual) {
          impulse = best;
          evaluation.update(impulse);
        }
        report.residual = evaluation.error;
        report.converged = report.residual <= control.tolerance;
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

      /// With 3520 of impactor.prm its longer steps cost three times as much as
      /// the shorter ones of the others; on scenes of up to some 1500 it wins.
      static constexpr unsigned long long few_unknowns = 2000;
      std::unique_ptr<NonsmoothSolver<dim>> newton_, path_, last_;
      AugmentedLagrangian<dim> joined_; ///< of bodies that share nodes
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
