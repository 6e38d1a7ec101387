#include "nonsmooth/solver.h"

#include "core/accelerated_rounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    /**
     * Fixed point on damage and friction around the contact solve, the first
     * of the three procedures at the end of section 5.3 of [AM06]. With
     * the openings d' and the friction thresholds s of all points given, the
     * step is a convex problem for the dual Newton method; its solution gives
     * new d' and s. Points that are rigid before the step keep their full law
     * in that problem: next to U = 0 the secant T/d' is unbounded.
     *
     * Plain, or with the acceleration of Anderson (KINSOL of SUNDIALS). Every
     * round is judged by the natural map of the full laws. Above the bound of
     * a unique step the iteration diverges or cycles: it is given up when a
     * number of rounds has not halved the error, and the best round is kept.
     */
    template <int dim>
    class FixedPoint : public NonsmoothSolver<dim>
    {
    public:
      explicit FixedPoint(const unsigned int anderson = 0)
          : anderson_(anderson),
            inner_(SolverRegistry<dim>::instance().create("dual newton"))
      {
      }

      SolverReport solve(const OneStepProblem<dim> &problem,
                         DelassusOperator<dim> &delassus, double energy_scale,
                         const SolverControl &control,
                         std::vector<double> &impulse,
                         LawEvaluation<dim> &evaluation) override;

    private:
      using Vector = std::vector<double>;
      struct Round;

      unsigned int anderson_; // vectors kept; 0: plain
      std::unique_ptr<NonsmoothSolver<dim>> inner_;
    };

    /**
     * One solve: unknowns are the reach at the end of the step over d_0, and
     * s / s_0, of every point.
     */
    template <int dim>
    struct FixedPoint<dim>::Round {
      const OneStepProblem<dim> &problem;
      DelassusOperator<dim> &delassus;
      const SolverControl &control;
      NonsmoothSolver<dim> &inner;
      double energy_scale;
      Vector &impulse;
      LawEvaluation<dim> &evaluation;
      SolverReport &report;

      std::vector<FrozenPoint> frozen{};
      Vector length{};   // d_0 of a point
      double scale = 0.; // s_0
      Vector best{};
      double best_error = std::numeric_limits<double>::infinity();
      unsigned int idle = 0, rounds = 0;
      bool finished = false;

      /** Keep the round if it is the best; false: no more of them. */
      bool judge()
      {
        ++rounds;
        const double error = evaluation.error; // infinite without impulses
        idle = error < 0.5 * best_error ? 0 : idle + 1;
        if (error < best_error) {
          best_error = error;
          best = impulse;
        }
        finished = !(error > control.tolerance) ||
                   idle > 20 * (control.idle_rounds + 1) ||
                   rounds > control.iterations_or(200) || std::isnan(error);
        return !finished;
      }

      static constexpr unsigned int stride = 3;

      void set_reach(const Reach &reach, const std::size_t i, Vector &x) const
      {
        x[stride * i] = reach.opening / length[i];
        x[stride * i + 1] = reach.slip / length[i];
      }

      /** The unknowns that the present solution asks for. */
      Vector unknowns() const
      {
        Vector x(stride * problem.n_points, 0.);
        for (std::size_t i = 0; i < problem.n_points; ++i) {
          const auto &solution = evaluation.solutions[i];
          set_reach(solution.reach, i, x);
          x[stride * i + 2] =
              scale > 0. ? solution.frozen.threshold / scale : 0.;
        }
        return x;
      }

      /** x := G(x). */
      void apply(Vector &x)
      {
        for (std::size_t i = 0; i < problem.n_points; ++i) {
          frozen[i] =
              frozen_state<dim>(problem, i,
                                {std::max(0., x[stride * i]) * length[i],
                                 std::max(0., x[stride * i + 1]) * length[i]},
                                0.);
          frozen[i].threshold = std::max(0., x[stride * i + 2]) * scale;
        }
        SolverControl part = control;
        part.tolerance = std::max(0.1 * control.tolerance,
                                  std::min(1e-2, 1e-3 * evaluation.error));
        evaluation.freeze(&frozen);
        const SolverReport round = inner.solve(problem, delassus, energy_scale,
                                               part, impulse, evaluation);
        for (std::size_t i = 0; i < problem.n_points; ++i) {
          const auto &solution = evaluation.solutions[i];
          set_reach(solution.reach, i, x);
          x[stride * i + 2] = 0.;
          if (scale > 0. && evaluation.is_frozen(i))
            x[stride * i + 2] = frozen_state<dim>(problem, i, solution.reach,
                                                  solution.contact_impulse)
                                    .threshold /
                                scale;
        }
        evaluation.freeze(nullptr);
        evaluation.update(impulse);
        report.add_work(round);
      }

      /** Points of other ranks follow their owners. */
      void complete(Vector &x) const
      {
        Vector first = x, second = x;
        first.resize(stride * (problem.n_points + 1));
        second.resize(first.size());
        delassus.exchange({{first.data(), second.data()}}, stride);
        // what came in is on the side that this rank does not compute
        for (const auto &neighbor : delassus.points().neighbors)
          for (std::size_t j = 0; j < neighbor.points.size(); ++j)
            if (const std::size_t i = neighbor.points[j]; i >= problem.n_owned)
              for (std::size_t c = stride * i; c < stride * (i + 1); ++c)
                x[c] = (neighbor.side[j] == 0 ? second : first)[c];
      }
    };

    template <int dim>
    SolverReport FixedPoint<dim>::solve(const OneStepProblem<dim> &problem,
                                        DelassusOperator<dim> &delassus,
                                        const double energy_scale,
                                        const SolverControl &control,
                                        Vector &impulse,
                                        LawEvaluation<dim> &evaluation)
    {
      SolverReport report;
      Round round{problem,      delassus, control,    *inner_,
                  energy_scale, impulse,  evaluation, report};
      round.frozen.resize(problem.n_points);
      round.length.assign(problem.n_points, 1.);
      for (std::size_t i = 0; i < problem.n_points; ++i)
        if (problem.kind[i] == PointKind::cohesive ||
            problem.kind[i] == PointKind::rigid) {
          const auto &law = *problem.interactions[problem.interaction[i]].law;
          round.length[i] = law.toughness() / law.strength();
        }
      evaluation.update(impulse);
      const auto &communicator = delassus.communicator();
      for (const auto &solution : evaluation.solutions)
        round.scale = std::max(round.scale, solution.frozen.threshold);
      for (const double P : impulse)
        round.scale = std::max(round.scale, std::abs(P));
      round.scale = communicator.max(round.scale);

      if (round.judge()) {
        Vector x = round.unknowns();
        if (anderson_ > 0) {
          const std::size_t n = Round::stride * problem.n_owned;
          Vector owned(x.begin(), x.begin() + n);
          accelerated_rounds(communicator, anderson_,
                             control.iterations_or(200) + 1, owned,
                             [&](Vector &mixed) {
                               std::copy_n(mixed.begin(), n, x.begin());
                               round.complete(x);
                               round.apply(x);
                               const bool goes_on = round.judge();
                               std::copy_n(x.begin(), n, mixed.begin());
                               return goes_on;
                             });
          // It also stops where the unknowns rest and the impulses do not,
          // and mixing may stall where forces are not unique: plain rounds
          // from nothing.
          if (evaluation.error > control.tolerance) {
            std::fill(impulse.begin(), impulse.end(), 0.);
            evaluation.update(impulse);
            x = round.unknowns();
            round.idle = round.rounds = 0;
            round.finished = false;
          }
        }
        while (!round.finished) {
          round.apply(x);
          round.judge();
        }
      }
      if (evaluation.error > round.best_error) {
        impulse = round.best;
        evaluation.update(impulse);
      }
      report.residual = evaluation.error;
      report.converged = evaluation.error <= control.tolerance;
      return report;
    }

    template <int dim>
    class AcceleratedFixedPoint final : public FixedPoint<dim>
    {
    public:
      AcceleratedFixedPoint() : FixedPoint<dim>(5) {}
    };

    using FixedPoint2 = FixedPoint<2>;
    using FixedPoint3 = FixedPoint<3>;
    using Accelerated2 = AcceleratedFixedPoint<2>;
    using Accelerated3 = AcceleratedFixedPoint<3>;
    NSFD_REGISTER(SolverRegistry<2>, FixedPoint2, "fixed point",
                  "damage and friction outside of a convex contact solve; for "
                  "steps below the bound of a unique solution");
    NSFD_REGISTER(SolverRegistry<3>, FixedPoint3, "fixed point",
                  "damage and friction outside of a convex contact solve; for "
                  "steps below the bound of a unique solution");
    NSFD_REGISTER(SolverRegistry<2>, Accelerated2, "anderson",
                  "the fixed point with the acceleration of Anderson (KINSOL)");
    NSFD_REGISTER(SolverRegistry<3>, Accelerated3, "anderson",
                  "the fixed point with the acceleration of Anderson (KINSOL)");
  } // namespace
} // namespace nsfd
