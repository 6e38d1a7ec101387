#include "dual_newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    template <int dim>
    bool softens(const LawEvaluation<dim> &evaluation)
    {
      return std::any_of(evaluation.solutions.begin(),
                         evaluation.solutions.end(),
                         [](const auto &s) { return s.damages; });
    }
  } // namespace

  /**
   * Exact line search on the convex dual objective with the thresholds of
   * the current point frozen, between the local solutions at P and at
   * P + dP, both in the domain of the objective. Its slope along the line is
   *
   *     d . (U_free + W P_alpha - U_law(P_alpha)),   increasing in alpha.
   */
  template <int dim>
  bool DualNewton<dim>::line_search(const Work &work, const Vector &direction,
                                    Vector &impulse)
  {
    const auto &problem = work.problem;
    const auto &communicator = work.delassus.communicator();
    std::vector<FrozenPoint> frozen(problem.n_points);
    Vector start(work.n), d(work.n), Wd(work.n), U(work.n), moved(work.n);
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      frozen[i] = work.evaluation.solutions[i].frozen;
      for (unsigned int c = 0; c < dim; ++c)
        start[i * dim + c] = work.evaluation.solutions[i].impulse[c];
    }
    // U at P + dP, then its local solutions
    for (std::size_t k = 0; k < work.n; ++k)
      moved[k] = impulse[k] + direction[k];
    work.delassus.apply_delassus(moved.data(), U.data());
    for (std::size_t i = 0; i < problem.n_points; ++i) {
      std::array<double, dim> local;
      for (unsigned int c = 0; c < dim; ++c) {
        const std::size_t k = i * dim + c;
        local[c] =
            U[k] + problem.free_velocity[k] - majorant(work, k) * moved[k];
      }
      const auto solution = solve_frozen_point<dim>(
          problem, i, frozen[i], local, work.evaluation.majorant(i, 0),
          work.evaluation.majorant(i, 1));
      for (unsigned int c = 0; c < dim; ++c)
        d[i * dim + c] = solution.impulse[c] - start[i * dim + c];
    }
    work.delassus.apply_delassus(d.data(), Wd.data());
    work.delassus.apply_delassus(start.data(), U.data());
    for (std::size_t k = 0; k < work.n; ++k)
      U[k] += problem.free_velocity[k];

    Vector terms(work.n_owned);
    const auto slope = [&](const double alpha) {
      for (std::size_t i = 0; i < problem.n_owned; ++i) {
        std::array<double, dim> P;
        for (unsigned int c = 0; c < dim; ++c)
          P[c] = start[i * dim + c] + alpha * d[i * dim + c];
        const auto law = frozen_velocity<dim>(problem, i, frozen[i], P);
        for (unsigned int c = 0; c < dim; ++c) {
          const std::size_t k = i * dim + c;
          terms[k] = d[k] == 0. ? 0. : d[k] * (U[k] + alpha * Wd[k] - law[c]);
        }
      }
      return communicator.sum(terms.data(), work.n_owned);
    };
    ++work.report.line_searches;
    double low = 0., high = 1., at_low = slope(0.), at_high = slope(1.);
    if (!(at_low < 0.))
      return false;
    double alpha = 1.;
    if (at_high > 0.) {
      const double aim = 1e-3 * std::abs(at_low);
      for (unsigned int k = 0; k < 30; ++k) {
        alpha = low - at_low * (high - low) / (at_high - at_low);
        if (!(alpha > low && alpha < high) || k % 3 == 2)
          alpha = 0.5 * (low + high);
        const double value = slope(alpha);
        if (std::abs(value) <= aim)
          break;
        (value < 0. ? low : high) = alpha;
        (value < 0. ? at_low : at_high) = value;
      }
    }
    for (std::size_t k = 0; k < work.n; ++k)
      impulse[k] = start[k] + alpha * d[k];
    return true;
  }

  /** Shares of the step, down to a tenth, until one reduces the map. */
  template <int dim>
  bool DualNewton<dim>::shorten(const Work &work, const double before,
                                const Vector &dP, Vector &impulse,
                                Vector &trial)
  {
    for (const double share : {0.5, 0.25, 0.1}) {
      for (std::size_t k = 0; k < work.n; ++k)
        trial[k] = impulse[k] + share * dP[k];
      work.evaluation.update(trial);
      if (work.evaluation.error < (1. - 0.3 * share) * before) {
        impulse.swap(trial);
        return true;
      }
    }
    work.evaluation.update(impulse);
    return false;
  }

  template <int dim>
  SolverReport DualNewton<dim>::solve(const OneStepProblem<dim> &problem,
                                      DelassusOperator<dim> &delassus,
                                      const double,
                                      const SolverControl &control,
                                      std::vector<double> &impulse,
                                      LawEvaluation<dim> &evaluation)
  {
    SolverReport report;
    // small problems are solved to round-off where one step does it
    auto *const inner =
        delassus.communicator().sum_integer(problem.n_owned) > 1000
            ? dynamic_cast<InnerSolver *>(&delassus)
            : nullptr;
    const Work work{problem,
                    delassus,
                    control,
                    evaluation,
                    report,
                    problem.n_points * dim,
                    problem.n_owned * dim,
                    &impulse,
                    inner};
    Vector dP, best, trial;
    evaluation.update(impulse);
    // a solve that may not go on idly has a majorant that is not one of W
    const bool may_sweep =
        delassus.bodies_are_apart() && control.idle_rounds > 1;
    unsigned int stalled = 0, sweeps = 10, idle_rounds = 0;
    double best_error = std::numeric_limits<double>::infinity(),
           best_of_round = best_error, shift = 0.;
    const auto keep_best = [&] {
      if (evaluation.error < best_error) {
        best_error = evaluation.error;
        best = impulse;
      }
    };
    keep_best();
    const unsigned int most = control.iterations_or(200);
    while (evaluation.error > control.tolerance && report.newton < most) {
      ++report.newton;
      const double before = evaluation.error;
      // The inner tolerance falls with the error, never far below the goal.
      const double forcing = std::min(
          1e-2, std::max({before, 0.1 * control.tolerance / before, 1e-12}));
      const bool coupled = differentiate(work, impulse);
      if (coupled)
        coupled_direction(work, forcing, shift, dP);
      else
        symmetric_direction(work, forcing, dP);
      trial = impulse;
      for (std::size_t k = 0; k < work.n; ++k)
        trial[k] += dP[k];
      solutions_ = evaluation.solutions;
      defect_ = evaluation.defect;
      velocity_ = evaluation.velocity;
      evaluation.update(trial);
      if (evaluation.error < (coupled ? 0.7 : 0.5) * before ||
          evaluation.error <= control.tolerance) {
        impulse.swap(trial);
        stalled = 0;
        keep_best();
        continue;
      }
      shift = 1e-3;
      evaluation.solutions = solutions_;
      evaluation.defect = defect_;
      evaluation.velocity = velocity_;
      evaluation.error = before;
      if (coupled && shorten(work, before, dP, impulse, trial)) {
        keep_best();
        continue;
      }
      if (coupled)
        symmetric_direction(work, forcing, dP);
      bool moved = line_search(work, dP, impulse);
      evaluation.update(impulse);
      keep_best();
      // Monotone in the convex objective: let it run a few times.
      if (moved &&
          (coupled ? stalled >= 4 && stalled % 5 != 4 : stalled % 5 != 4)) {
        ++stalled;
        continue;
      }
      if (evaluation.is_frozen()) {
        if (!moved)
          break;
        ++stalled;
        continue;
      }
      if (moved && evaluation.error < 0.7 * before) {
        stalled = 0;
        continue;
      }
      ++stalled;
      // A cycle or several solutions: more of the same seldom helps, and a
      // shorter step does, at once where points soften.
      idle_rounds = best_error < 0.5 * best_of_round ? 0 : idle_rounds + 1;
      best_of_round = best_error;
      const bool soft = delassus.communicator().any(softens(evaluation));
      if (idle_rounds > control.idle_rounds / (soft ? 4 : 1) ||
          report.sweeps >= 5 * most)
        break;
      // Without friction and damage it is round-off of long steps that stops
      // Newton's method; sweeps, which use W alone, have less of it. Where laws
      // are coupled they cost more than they bring.
      if (coupled || !may_sweep) {
        if (stalled > 4)
          break;
        continue;
      }
      if (colours_.empty())
        colours_ = colour_faces(delassus);
      if (report.sweeps == 0)
        report.switches.push_back("gauss seidel");
      if (best_error < 0.5 * evaluation.error)
        impulse = best;
      gauss_seidel(problem, delassus, colours_, sweeps, impulse);
      report.sweeps += sweeps;
      sweeps = std::min(80u, sweeps * 2);
      evaluation.update(impulse);
      keep_best();
      if (!(evaluation.error < std::numeric_limits<double>::infinity()))
        break;
    }
    if (evaluation.error > best_error) {
      impulse = best;
      evaluation.update(impulse);
    }
    report.residual = evaluation.error;
    report.converged = evaluation.error <= control.tolerance;
    return report;
  }

  template class DualNewton<2>;
  template class DualNewton<3>;

  namespace
  {
    using DualNewton2 = DualNewton<2>;
    using DualNewton3 = DualNewton<3>;
    NSFD_REGISTER(SolverRegistry<2>, DualNewton2, "dual newton",
                  "Newton on the dual problem, friction and damage in its "
                  "derivative; in a run with exact line search");
    NSFD_REGISTER(SolverRegistry<3>, DualNewton3, "dual newton",
                  "Newton on the dual problem, friction and damage in its "
                  "derivative; in a run with exact line search");
  } // namespace
} // namespace nsfd
