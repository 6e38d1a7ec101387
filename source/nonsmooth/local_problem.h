#pragma once

#include "damage.h"
#include "springs.h"

#include "cohesive_laws/friction_weight.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nsfd::local
{
  using namespace springs;

  template <int dim>
  std::array<double, dim> end_jump(const OneStepProblem<dim> &problem,
                                   const std::size_t i,
                                   const std::array<double, dim> &velocity)
  {
    std::array<double, dim> jump;
    for (unsigned int c = 0; c < dim; ++c)
      jump[c] = problem.jump_free[i * dim + c] +
                problem.time_step * problem.theta * velocity[c];
    return jump;
  }

  template <int dim>
  Reach end_reach(const OneStepProblem<dim> &problem, const std::size_t i,
                  const std::array<double, dim> &velocity)
  {
    const auto jump = end_jump<dim>(problem, i, velocity);
    return reach_of<dim>(problem.interactions[problem.interaction[i]],
                         jump.data());
  }

  /** Friction bound for beta at the end of the step. */
  template <int dim>
  double threshold_for(const OneStepProblem<dim> &problem, const std::size_t i,
                       const double beta, const double contact_impulse)
  {
    if (contact_impulse <= 0.)
      return 0.;
    const auto &interaction = problem.interactions[problem.interaction[i]];
    return friction_of(problem, i) *
           kappa(beta, interaction.friction_exponent) * contact_impulse;
  }

  template <int dim>
  void solve_normal(const OneStepProblem<dim> &problem, const std::size_t i,
                    const FrozenPoint &frozen, const double local,
                    const double majorant, LocalSolution<dim> &solution)
  {
    const NormalLaw law = normal_law<dim>(problem, i, frozen.secant.normal);
    const double wh = problem.weight[i] * problem.time_step;
    const double target = problem.target[i] + frozen.lift;
    double U = law.solve(local, majorant * wh);
    solution.contact_impulse = 0.;
    if (problem.contact[i] && U < target) {
      U = target;
      solution.impulse[0] = (U - local) / majorant;
      solution.contact_impulse = solution.impulse[0] + wh * law.at(U);
      solution.status = PointStatus::stick;
    } else {
      // a stiff spring: its traction is a difference of large jumps
      solution.impulse[0] = majorant * wh * law.derivative(U) > 1.
                                ? (U - local) / majorant
                                : -wh * law.at(U);
      solution.status = PointStatus::open;
    }
    solution.velocity[0] = U;
  }

  template <int dim>
  void solve_tangential(const OneStepProblem<dim> &problem, const std::size_t i,
                        const FrozenPoint &frozen,
                        const std::array<double, dim> &local,
                        const double majorant, LocalSolution<dim> &solution)
  {
    const TangentialSpring spring =
        tangential_spring<dim>(problem, frozen.secant.tangential);
    const double k = problem.weight[i] * problem.time_step *
                     spring.stiffness; // impulse per unit of y
    const double factor = 1. + majorant * k * spring.slope;
    double z[dim] = {}, norm = 0.;
    for (unsigned int c = 1; c < dim; ++c) {
      const double offset = problem.sliding_offset[i * dim + c];
      z[c] = local[c] + factor * offset -
             majorant * k * tangential_offset<dim>(problem, i, c);
      norm += z[c] * z[c];
    }
    norm = std::sqrt(norm);
    const double bound = majorant * frozen.threshold;
    const double share = norm > bound ? (1. - bound / norm) / factor : 0.;
    for (unsigned int c = 1; c < dim; ++c) {
      const double U = share * z[c] - problem.sliding_offset[i * dim + c];
      solution.velocity[c] = U;
      solution.impulse[c] =
          frozen.threshold == 0. && factor < 2.
              ? -k * (tangential_offset<dim>(problem, i, c) + spring.slope * U)
              : (U - local[c]) / majorant;
    }
    if (solution.status == PointStatus::stick && share > 0.)
      solution.status = PointStatus::slide;
  }

  /** One local problem: everything at a given frozen part. */
  template <int dim>
  struct LocalProblem {
    const OneStepProblem<dim> &problem;
    std::size_t i;
    const std::array<double, dim> &local;
    double majorant_normal, majorant_tangential;
    LocalSolution<dim> solution{};
    /// nobody asks how far other points are open
    const bool has_law = problem.kind[i] == PointKind::cohesive ||
                         problem.kind[i] == PointKind::rigid;

    const Interaction &interaction() const
    {
      return problem.interactions[problem.interaction[i]];
    }

    bool lifts() const
    {
      return problem.contact[i] &&
             (interaction().wear > 0. ||
              (!problem.dilatancy.empty() && problem.dilatancy[i] > 0.));
    }

    void solve(const FrozenPoint &frozen)
    {
      solve_normal<dim>(problem, i, frozen, local[0], majorant_normal,
                        solution);
      solve_tangential<dim>(problem, i, frozen, local, majorant_tangential,
                            solution);
      solution.frozen = frozen;
      if (has_law)
        solution.reach = end_reach<dim>(problem, i, solution.velocity);
    }

    /**
     * At a given secant: friction follows the normal part at once, with
     * @p beta() asked for where there is any.
     */
    template <typename Beta>
    void solve(const Secant &secant, const Beta &beta)
    {
      FrozenPoint frozen{secant};
      if (lifts()) {
        solve_lifted(frozen, beta());
        return;
      }
      solve_normal<dim>(problem, i, frozen, local[0], majorant_normal,
                        solution);
      if (solution.contact_impulse > 0. && interaction().friction > 0.)
        frozen.threshold =
            threshold_for(problem, i, beta(), solution.contact_impulse);
      solve_tangential<dim>(problem, i, frozen, local, majorant_tangential,
                            solution);
      solution.frozen = frozen;
      if (has_law)
        solution.reach = end_reach<dim>(problem, i, solution.velocity);
    }

    /** With the secant and beta of an end of the step. */
    void solve_end(const PointDamage<dim> &damage, const Reach &end)
    {
      solve(damage.secant(end),
            [&] { return damage.beta(damage.history_after(end)); });
    }

  private:
    /** The contact impulse at U_N = target + @p lift, at least 0. */
    double contact_impulse(const Secant &secant, const double lift) const
    {
      const double U = problem.target[i] + lift;
      const double wh = problem.weight[i] * problem.time_step;
      return positive((U - local[0]) / majorant_normal +
                      wh * normal_law<dim>(problem, i, secant.normal).at(U));
    }

    /**
     * The speed at which the surfaces part while they slide at @p speed:
     * dilatancy, less the wear under the pressure that follows.
     */
    double lift_at(const Secant &secant, const double speed) const
    {
      const double h = problem.time_step;
      const double up =
          problem.dilatancy.empty()
              ? 0.
              : std::min(problem.dilatancy[i] * speed,
                         problem.lift_left[i] / (h * problem.theta));
      const double k = interaction().wear * speed / (problem.weight[i] * h);
      if (k == 0.)
        return up;
      const auto excess = [&](const double depth) {
        return k * contact_impulse(secant, up - depth) - depth;
      };
      const double deepest = k * contact_impulse(secant, up);
      return deepest == 0. ? up
                           : up - bracketed_root(excess, 0., deepest, deepest,
                                                 excess(deepest));
    }

    /** Sliding and what it does to the contact, at once. */
    void solve_lifted(FrozenPoint frozen, const double beta)
    {
      const auto excess = [&](const double speed) {
        frozen.lift = lift_at(frozen.secant, speed);
        frozen.threshold = threshold_for(
            problem, i, beta, contact_impulse(frozen.secant, frozen.lift));
        solve(frozen);
        return sliding_speed<dim>(problem, i, solution.velocity) - speed;
      };
      const double stuck = excess(0.);
      solution.coupled = true;
      if (stuck <= 0.)
        return;
      frozen.threshold = 0.;
      solve(frozen);
      const double free = sliding_speed<dim>(problem, i, solution.velocity);
      excess(bracketed_root(excess, 0., free, stuck, excess(free)));
      solution.coupled = true;
    }
  };

  /**
   * The root of @p excess next to @p start in [low, high], where it falls
   * from positive to negative; the upper end may have to go further. A sign
   * change between two @p kinks of the law comes before one further on.
   */
  template <typename Function>
  double adjacent_root(const Function &excess, double low, double high,
                       const double start,
                       const std::array<double, 3> &kinks = {})
  {
    double f_low = excess(low), f_high = excess(high);
    // a spring that is crossed (u and u' on both sides) may push further
    for (unsigned int k = 0; k < 60 && f_high > 0.; ++k)
      f_high = excess(high *= 2.);
    if (f_low <= 0.)
      return low;
    const auto split = [&](const double x) {
      const double f = excess(x);
      (f > 0. ? low : high) = x;
      (f > 0. ? f_low : f_high) = f;
    };
    if (start > low && start < high)
      split(start);
    for (const double kink : kinks)
      if (kink > low && kink < high)
        split(kink);
    return f_high >= 0. ? high
                        : bracketed_root(excess, low, high, f_low, f_high);
  }

  /**
   * A point that was beyond the end of its law in this solve stays there if it
   * can: where the traction drops at the end of the law, an end beyond it may
   * be the only one of the whole step, while the local problem has another one
   * within the history.
   */
  template <int dim>
  bool stays_broken(const PointDamage<dim> &damage, const Reach &start,
                    LocalProblem<dim> &local);

  /** Damage of one scalar: d' = d(u'(b(d'))), from @p low on. */
  template <int dim>
  void solve_damage(const PointDamage<dim> &damage, double low, double high,
                    double start, LocalProblem<dim> &local);

  /**
   * In a short step the end hardly depends on the secant that it makes: from
   * one end to that of its secant, with Broyden's change of the way, each
   * time at most half as far until round-off ends it, which may be 1e-12: the
   * mean secant of a short way is a quotient of small differences. False
   * where it is not so, and then nothing is said about an end.
   */
  template <int dim>
  bool follow_mixed_damage(const PointDamage<dim> &damage, const Reach &high,
                           const Reach &start, LocalProblem<dim> &local,
                           Reach &end);

  /**
   * Two scalars: the slip outside, and for each slip the opening that goes
   * with it; either may stay within its history.
   */
  template <int dim>
  void solve_mixed_damage(const PointDamage<dim> &damage, const Reach &high,
                          const Reach &start, LocalProblem<dim> &local);

  /** The sum of opening and slip: each has a traction of its own. */
  template <int dim>
  void solve_added(const PointDamage<dim> &damage, const Reach &start,
                   LocalProblem<dim> &local);
} // namespace nsfd::local
