#include "point_law.h"

#include "damage.h"
#include "springs.h"

#include "cohesive_laws/friction_weight.h"
#include "pull_and_shear.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  using namespace springs;

  namespace
  {
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
    double threshold_for(const Interaction &interaction, const double beta,
                         const double contact_impulse)
    {
      return contact_impulse <= 0.
                 ? 0.
                 : interaction.friction *
                       kappa(beta, interaction.friction_exponent) *
                       contact_impulse;
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
    void solve_tangential(const OneStepProblem<dim> &problem,
                          const std::size_t i, const FrozenPoint &frozen,
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
                ? -k *
                      (tangential_offset<dim>(problem, i, c) + spring.slope * U)
                : (U - local[c]) / majorant;
      }
      if (solution.status == PointStatus::stick && share > 0.)
        solution.status = PointStatus::slide;
    }

    template <int dim>
    LocalSolution<dim> solve_prescribed(const OneStepProblem<dim> &problem,
                                        const std::size_t i,
                                        const std::array<double, dim> &local,
                                        const double majorant_normal,
                                        const double majorant_tangential)
    {
      LocalSolution<dim> solution;
      solution.status = PointStatus::prescribed;
      for (unsigned int c = 0; c < dim; ++c) {
        const bool given = problem.mask[i] & (1u << c);
        solution.velocity[c] =
            given ? problem.given_velocity[i * dim + c] : local[c];
        solution.impulse[c] =
            given ? (solution.velocity[c] - local[c]) /
                        (c == 0 ? majorant_normal : majorant_tangential)
                  : 0.;
      }
      solution.frozen.secant = Secant::rigid();
      return solution;
    }

    /** U = 0 against the local velocity. */
    template <int dim>
    LocalSolution<dim> solve_held(const std::array<double, dim> &local,
                                  const double majorant_normal,
                                  const double majorant_tangential)
    {
      LocalSolution<dim> solution;
      solution.status = PointStatus::prescribed;
      for (unsigned int c = 0; c < dim; ++c)
        solution.impulse[c] =
            -local[c] / (c == 0 ? majorant_normal : majorant_tangential);
      solution.frozen.secant = Secant::rigid();
      return solution;
    }

    /** U = 0 held by a traction below the strength? Compression always is. */
    template <int dim>
    bool stays_rigid(const OneStepProblem<dim> &problem, const std::size_t i,
                     const std::array<double, dim> &impulse)
    {
      const double wh = problem.weight[i] * problem.time_step;
      const auto &interaction = problem.interactions[problem.interaction[i]];
      return pull_and_shear<dim>(-impulse[0], impulse.data() + 1,
                                 interaction.shear_weight) <=
             wh * point_strength<dim>(problem, i);
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
              threshold_for(interaction(), beta(), solution.contact_impulse);
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
              interaction(), beta, contact_impulse(frozen.secant, frozen.lift));
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
     * Where a law jumps, friction sets in at once, and the root of the local
     * problem can be the jump itself: with a secant and a threshold between
     * those of its two sides the step ends at just this opening.
     */
    template <int dim>
    void solve_between(LocalProblem<dim> &local, const FrozenPoint before,
                       const FrozenPoint after, const double opening)
    {
      const auto mix = [](const double share, const double a, const double b) {
        return a + share * (b - a);
      };
      const auto excess = [&](const double share) {
        const Secant &b = before.secant, &a = after.secant;
        local.solve({{mix(share, b.normal, a.normal),
                      mix(share, b.tangential, a.tangential)},
                     mix(share, before.threshold, after.threshold),
                     mix(share, before.lift, after.lift)});
        return local.solution.reach.opening - opening;
      };
      const double f_before = excess(0.), f_after = excess(1.);
      excess(bracketed_root(excess, 0., 1., f_before, f_after));
    }

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
     * Where the traction drops at the end of the law, an end beyond it may be
     * the only one of the whole step, while the local problem has another one
     * within the history: what was beyond in this solve stays there if it can.
     */
    template <int dim>
    bool stays_broken(const PointDamage<dim> &damage, const Reach &start,
                      LocalProblem<dim> &local)
    {
      const double end = damage.kinks().back();
      if (!(start.opening > end) || damage.history().opening >= end ||
          !damage.drops())
        return false;
      const auto excess = [&](const double opening) {
        local.solve_end(damage, {opening, 0.});
        return local.solution.reach.opening - opening;
      };
      double low = start.opening, high = low, f_low = excess(low),
             f_high = f_low;
      for (unsigned int k = 0; k < 60 && f_high > 0.; ++k)
        f_high = excess(high = end + 2. * (high - end));
      for (unsigned int k = 0; k < 60 && !(f_low > 0.); ++k)
        f_low = excess(low = end + 0.5 * (low - end));
      if (!(f_low > 0. && f_high <= 0.))
        return false;
      const double root = bracketed_root(excess, low, high, f_low, f_high);
      excess(root);
      local.solution.reach = {root, 0.};
      local.solution.damages = true;
      return true;
    }

    /** Damage of one scalar: d' = d(u'(b(d'))), from @p low on. */
    template <int dim>
    void solve_damage(const PointDamage<dim> &damage, const double low,
                      const double high, const double start,
                      LocalProblem<dim> &local)
    {
      const auto excess = [&](const double opening) {
        const Reach end{opening, 0.};
        local.solve_end(damage, end);
        return local.solution.reach.opening - opening;
      };
      const double root =
          adjacent_root(excess, low, high, start, damage.kinks());
      if (std::abs(excess(root)) > 1e-9 * root && !damage.plateau()) {
        excess(root * (1. - 1e-15));
        const FrozenPoint before = local.solution.frozen;
        excess(root * (1. + 1e-15));
        solve_between<dim>(local, before, local.solution.frozen, root);
      }
      local.solution.reach = {root, 0.};
    }

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
                             Reach &end)
    {
      using Pair = std::array<double, 2>;
      const Pair low{{damage.history().opening, damage.history().slip}};
      Pair x{{std::clamp(start.opening, low[0], high.opening),
              std::clamp(start.slip, low[1], high.slip)}};
      std::array<Pair, 2> H{{{{1., 0.}}, {{0., 1.}}}}; // step over distance
      Pair step{}, last{};
      const auto product = [&](const Pair &v) {
        return Pair{
            {H[0][0] * v[0] + H[0][1] * v[1], H[1][0] * v[0] + H[1][1] * v[1]}};
      };
      const auto size = [](const Pair &v) {
        return std::abs(v[0]) + std::abs(v[1]);
      };
      for (unsigned int k = 0; k < 12; ++k) {
        local.solve_end(damage, {x[0], x[1]});
        const Reach &reach = local.solution.reach;
        const Pair to{
            {std::max(low[0], reach.opening), std::max(low[1], reach.slip)}};
        const Pair distance{{to[0] - x[0], to[1] - x[1]}};
        const bool nearer = k == 0 || size(distance) < 0.5 * size(last);
        if (size(distance) <= (nearer ? 1e-14 : 1e-12) * size(to)) {
          end = {to[0], to[1]};
          return true;
        }
        if (!nearer)
          return false;
        if (k > 0) {
          const Pair change =
              product({{distance[0] - last[0], distance[1] - last[1]}});
          const double along = step[0] * change[0] + step[1] * change[1];
          if (!(along < 0.))
            return false;
          const Pair row{{step[0] * H[0][0] + step[1] * H[1][0],
                          step[0] * H[0][1] + step[1] * H[1][1]}};
          for (unsigned int r = 0; r < 2; ++r)
            for (unsigned int c = 0; c < 2; ++c)
              H[r][c] -= (step[r] + change[r]) * row[c] / along;
        }
        const Pair way = product(distance);
        for (unsigned int c = 0; c < 2; ++c) {
          const double next = std::max(low[c], x[c] + way[c]);
          step[c] = next - x[c];
          x[c] = next;
        }
        last = distance;
      }
      return false;
    }

    /**
     * Two scalars: the slip outside, and for each slip the opening that goes
     * with it; either may stay within its history.
     */
    template <int dim>
    void solve_mixed_damage(const PointDamage<dim> &damage, const Reach &high,
                            const Reach &start, LocalProblem<dim> &local)
    {
      const Reach &low = damage.history();
      const auto finish = [&](const Reach &root) {
        // where nothing grows, the point is where its springs are
        Reach &end = local.solution.reach;
        if (root.opening > low.opening)
          end.opening = root.opening;
        if (root.slip > low.slip)
          end.slip = root.slip;
      };
      Reach end;
      if (follow_mixed_damage<dim>(damage, high, start, local, end)) {
        finish(end);
        return;
      }
      const auto reach = [&](const Reach &at) -> const Reach & {
        local.solve_end(damage, at);
        return local.solution.reach;
      };
      double opening = low.opening;
      const auto slip_excess = [&](const double slip) {
        const auto excess = [&](const double x) {
          return reach({x, slip}).opening - x;
        };
        opening = high.opening > low.opening
                      ? adjacent_root(excess, low.opening, high.opening,
                                      start.opening)
                      : low.opening;
        return reach({opening, slip}).slip - slip;
      };
      const double slip =
          high.slip > low.slip
              ? adjacent_root(slip_excess, low.slip, high.slip, start.slip)
              : low.slip;
      slip_excess(slip);
      finish({opening, slip});
    }
  } // namespace

  template <int dim>
  void OneStepProblem<dim>::resize(const std::size_t n)
  {
    n_points = n;
    kind.assign(n, PointKind::free);
    mask.assign(n, 0);
    contact.assign(n, 0);
    interaction.assign(n, 0);
    for (auto *array : {&weight, &opening_max, &compression_stiffness, &target,
                        &majorant_normal, &majorant_tangential})
      array->assign(n, 0.);
    for (auto *array : {&slip_max, &viscosity, &dilatancy, &lift_left})
      array->clear();
    for (auto *array : {&strength_factor, &opening_factor})
      array->assign(n, 1.);
    for (auto *array : {&free_velocity, &given_velocity, &jump_old, &jump_free,
                        &sliding_offset})
      array->assign(n * dim, 0.);
  }

  template <int dim>
  double sliding_speed(const OneStepProblem<dim> &problem, const std::size_t i,
                       const std::array<double, dim> &velocity)
  {
    double sum = 0.;
    for (unsigned int c = 1; c < dim; ++c)
      sum += square(velocity[c] + problem.sliding_offset[i * dim + c]);
    return std::sqrt(sum);
  }

  template <int dim>
  double effective_opening(const Interaction &interaction, const double *jump)
  {
    double slip = 0.;
    for (unsigned int c = 1; c < dim; ++c)
      slip += jump[c] * jump[c];
    return std::sqrt(square(positive(jump[0])) +
                     interaction.shear_weight * slip);
  }

  template <int dim>
  Reach reach_of(const Interaction &interaction, const double *jump)
  {
    if (!interaction.law || !interaction.law->mixed())
      return {effective_opening<dim>(interaction, jump), 0.};
    double slip = 0.;
    for (unsigned int c = 1; c < dim; ++c)
      slip += jump[c] * jump[c];
    return {positive(jump[0]), std::sqrt(slip)};
  }

  bool past_peak(const CohesiveLaw &law, const double opening_factor,
                 const Reach &history)
  {
    const double x = opening_factor * history.opening;
    if (!law.mixed())
      return x >= law.peak_opening();
    const double y = opening_factor * history.slip;
    return square(x / law.peak_opening()) +
               square(y / law.mixed()->peak_slip()) >=
           1.;
  }

  double beta_of(const Interaction &interaction, const PointKind kind,
                 const double opening_factor, const Reach &history)
  {
    if (kind == PointKind::free)
      return 0.;
    if (kind != PointKind::cohesive)
      return 1.;
    const auto &law = *interaction.law;
    const double x = opening_factor * history.opening;
    return law.mixed() ? law.mixed()->beta(x, opening_factor * history.slip)
                       : law.beta(x);
  }

  template <int dim>
  double point_strength(const OneStepProblem<dim> &problem, const std::size_t i)
  {
    return PointDamage<dim>(problem, i).strength();
  }

  template <int dim>
  bool has_frozen_law(const OneStepProblem<dim> &problem, const std::size_t i)
  {
    const auto &interaction = problem.interactions[problem.interaction[i]];
    return problem.kind[i] != PointKind::rigid && !interaction.plateau &&
           interaction.wear == 0. &&
           (problem.dilatancy.empty() || problem.dilatancy[i] == 0.);
  }

  template <int dim>
  LinearPoint<dim>
  linear_point(const OneStepProblem<dim> &problem, const std::size_t i,
               const double majorant_normal, const double majorant_tangential)
  {
    LinearPoint<dim> result;
    const auto &interaction = problem.interactions[problem.interaction[i]];
    const bool elastic = problem.kind[i] == PointKind::elastic;
    if (problem.kind[i] == PointKind::free && !problem.contact[i]) {
      result.largest = infinity; // nothing acts
      return result;
    }
    if ((!elastic && problem.kind[i] != PointKind::cohesive) ||
        problem.contact[i] || problem.compression_stiffness[i] == 0. ||
        (!problem.viscosity.empty() && problem.viscosity[i] > 0.))
      return result;
    if (elastic) {
      const double C = interaction.normal_stiffness;
      result.secant = {C, C * interaction.stiffness_ratio};
      result.largest = infinity;
    } else {
      const PointDamage<dim> damage(problem, i);
      if (damage.plateau() || interaction.law->mixed())
        return result;
      result.secant = damage.secant(damage.history());
      result.largest = square(damage.history().opening);
    }
    if (result.secant.normal != problem.compression_stiffness[i]) {
      result.largest = -1.;
      return result;
    }
    const TangentialSpring spring =
        tangential_spring<dim>(problem, result.secant.tangential);
    result.slope = spring.slope;
    for (unsigned int c = 0; c < dim; ++c)
      result.offset[c] = tangential_offset<dim>(problem, i, c);
    const double wh = problem.weight[i] * problem.time_step;
    const auto kappa = [&](const double b, const double R) {
      return wh * b / (1. + R * wh * b * spring.slope);
    };
    result.normal = kappa(result.secant.normal, majorant_normal);
    result.tangential = kappa(result.secant.tangential, majorant_tangential);
    result.normal_majorant = majorant_normal;
    result.tangential_majorant = majorant_tangential;
    return result;
  }

  template <int dim>
  LocalSolution<dim> solve_frozen_point(const OneStepProblem<dim> &problem,
                                        const std::size_t i,
                                        const FrozenPoint &frozen,
                                        const std::array<double, dim> &local,
                                        const double majorant_normal,
                                        const double majorant_tangential)
  {
    if (problem.kind[i] == PointKind::prescribed)
      return solve_prescribed<dim>(problem, i, local, majorant_normal,
                                   majorant_tangential);
    if (frozen.is_rigid()) {
      auto solution =
          solve_held<dim>(local, majorant_normal, majorant_tangential);
      solution.frozen = frozen;
      solution.reach = end_reach<dim>(problem, i, solution.velocity);
      return solution;
    }
    LocalProblem<dim> here{problem, i, local, majorant_normal,
                           majorant_tangential};
    here.solve(frozen);
    return here.solution;
  }

  template <int dim>
  LocalSolution<dim>
  solve_point(const OneStepProblem<dim> &problem, const std::size_t i,
              const std::array<double, dim> &local,
              const double majorant_normal, const double majorant_tangential,
              const Reach &start)
  {
    const PointKind kind = problem.kind[i];
    if (kind == PointKind::prescribed)
      return solve_prescribed<dim>(problem, i, local, majorant_normal,
                                   majorant_tangential);

    LocalProblem<dim> here{problem, i, local, majorant_normal,
                           majorant_tangential};
    auto &solution = here.solution;
    const auto finish = [&](const bool follows) {
      solution.coupled |= follows || solution.frozen.threshold > 0.;
      return solution;
    };
    if (kind == PointKind::free || kind == PointKind::elastic) {
      const auto &interaction = here.interaction();
      const double b =
          kind == PointKind::elastic ? interaction.normal_stiffness : 0.;
      here.solve(Secant{b, b * interaction.stiffness_ratio},
                 [&] { return kind == PointKind::elastic ? 1. : 0.; });
      return finish(false);
    }

    const PointDamage<dim> damage(problem, i);
    const Reach &history = damage.history();
    double low = history.opening;
    if (kind == PointKind::rigid) {
      const auto held =
          solve_held<dim>(local, majorant_normal, majorant_tangential);
      if (stays_rigid<dim>(problem, i, held.impulse))
        return held;
      // opens: friction alone may still hold it, or its kappa
      here.solve(Secant(), [&] { return damage.beta({}); });
      const double high = solution.reach.opening;
      if (high == 0.)
        return held;
      low = 1e-9 * high;
      here.solve_end(damage, {low, 0.});
      if (solution.reach.opening <= low)
        return held;
      solve_damage<dim>(damage, low, high, start.opening, here);
      solution.damages = true;
      return finish(true);
    }
    if (!damage.plateau()) {
      if (stays_broken<dim>(damage, start, here))
        return finish(true);
      here.solve_end(damage, history);
      if (!damage.grows(solution.reach))
        return finish(false);
    }
    here.solve(Secant(), [&] { return damage.beta(history); });
    const Reach high{std::max(solution.reach.opening, history.opening),
                     std::max(solution.reach.slip, history.slip)};
    if (damage.plateau()) {
      // set-valued at u = 0, the traction of its history elsewhere
      low = 1e-9 * high.opening;
      if (high.opening == 0.)
        return finish(false);
    }
    if (!here.interaction().law->mixed())
      solve_damage<dim>(damage, low, high.opening, start.opening, here);
    else
      solve_mixed_damage<dim>(damage, high, start, here);
    solution.damages = !damage.plateau() || damage.grows(solution.reach);
    return finish(true);
  }

  template <int dim>
  std::array<double, dim>
  frozen_slopes(const OneStepProblem<dim> &problem, const std::size_t i,
                const FrozenPoint &frozen, const LocalSolution<dim> &solution,
                const double majorant_normal, const double majorant_tangential)
  {
    std::array<double, dim> slopes{};
    if (problem.kind[i] == PointKind::prescribed) {
      for (unsigned int c = 0; c < dim; ++c)
        if (problem.mask[i] & (1u << c))
          slopes[c] = 1. / (c == 0 ? majorant_normal : majorant_tangential);
      return slopes;
    }
    if (frozen.is_rigid()) {
      for (unsigned int c = 0; c < dim; ++c)
        slopes[c] = 1. / (c == 0 ? majorant_normal : majorant_tangential);
      return slopes;
    }
    const double wh = problem.weight[i] * problem.time_step;
    if (solution.status == PointStatus::open) {
      const double k = wh * normal_law<dim>(problem, i, frozen.secant.normal)
                                .derivative(solution.velocity[0]);
      slopes[0] = k / (1. + majorant_normal * k);
    } else
      slopes[0] = 1. / majorant_normal;

    const TangentialSpring spring =
        tangential_spring<dim>(problem, frozen.secant.tangential);
    const double k = wh * spring.stiffness * spring.slope;
    const double sliding = sliding_speed<dim>(problem, i, solution.velocity);
    if (frozen.threshold > 0. && sliding == 0.) {
      for (unsigned int c = 1; c < dim; ++c)
        slopes[c] = 1. / majorant_tangential;
    } else {
      slopes[1] = k / (1. + majorant_tangential * k);
      if (dim == 3) {
        // across the sliding direction the friction force turns
        const double turning =
            k + (frozen.threshold > 0. ? frozen.threshold / sliding : 0.);
        slopes[dim - 1] = turning / (1. + majorant_tangential * turning);
      }
    }
    return slopes;
  }

  template <int dim>
  std::array<double, dim>
  frozen_velocity(const OneStepProblem<dim> &problem, const std::size_t i,
                  const FrozenPoint &frozen,
                  const std::array<double, dim> &impulse)
  {
    std::array<double, dim> velocity{};
    if (problem.kind[i] == PointKind::prescribed) {
      for (unsigned int c = 0; c < dim; ++c)
        velocity[c] = problem.given_velocity[i * dim + c];
      return velocity;
    }
    if (frozen.is_rigid())
      return velocity;
    const double wh = problem.weight[i] * problem.time_step;
    const NormalLaw normal = normal_law<dim>(problem, i, frozen.secant.normal);
    const double target =
        problem.contact[i] ? problem.target[i] + frozen.lift : -infinity;
    const double traction = -impulse[0] / wh;
    if (normal.is_flat(traction))
      velocity[0] = problem.contact[i] ? target : normal.start;
    else
      velocity[0] = std::max(target, normal.inverse(traction));

    const TangentialSpring spring =
        tangential_spring<dim>(problem, frozen.secant.tangential);
    const double k = wh * spring.stiffness;
    double z[dim] = {}, norm = 0.;
    for (unsigned int c = 1; c < dim; ++c) {
      z[c] = -impulse[c] -
             k * (tangential_offset<dim>(problem, i, c) -
                  spring.slope * problem.sliding_offset[i * dim + c]);
      norm += z[c] * z[c];
    }
    norm = std::sqrt(norm);
    const double stiffness = k * spring.slope;
    const double share = norm > frozen.threshold && stiffness > 0.
                             ? (1. - frozen.threshold / norm) / stiffness
                             : 0.;
    for (unsigned int c = 1; c < dim; ++c)
      velocity[c] = share * z[c] - problem.sliding_offset[i * dim + c];
    return velocity;
  }

  template <int dim>
  FrozenPoint frozen_state(const OneStepProblem<dim> &problem,
                           const std::size_t i, const Reach &end,
                           const double contact_impulse)
  {
    const auto &interaction = problem.interactions[problem.interaction[i]];
    FrozenPoint frozen;
    double beta = 1.;
    switch (problem.kind[i]) {
    case PointKind::prescribed:
      frozen.secant = Secant::rigid();
      return frozen;
    case PointKind::rigid:
      return frozen; // has no secant before it opens
    case PointKind::bonded:
    case PointKind::parted:
    case PointKind::free:
      beta = 0.;
      break;
    case PointKind::elastic:
      frozen.secant = {interaction.normal_stiffness,
                       interaction.normal_stiffness *
                           interaction.stiffness_ratio};
      break;
    case PointKind::cohesive:
      const PointDamage<dim> damage(problem, i);
      frozen.secant = damage.secant(end);
      beta = damage.beta(damage.history_after(end));
      break;
    }
    frozen.threshold = threshold_for(interaction, beta, contact_impulse);
    return frozen;
  }

#define INSTANTIATE(dim)                                                       \
  template FrozenPoint frozen_state<dim>(const OneStepProblem<dim> &,          \
                                         std::size_t, const Reach &, double);  \
  template struct OneStepProblem<dim>;                                         \
  template LocalSolution<dim> solve_point<dim>(                                \
      const OneStepProblem<dim> &, std::size_t,                                \
      const std::array<double, dim> &, double, double, const Reach &);         \
  template LocalSolution<dim> solve_frozen_point<dim>(                         \
      const OneStepProblem<dim> &, std::size_t, const FrozenPoint &,           \
      const std::array<double, dim> &, double, double);                        \
  template std::array<double, dim> frozen_slopes<dim>(                         \
      const OneStepProblem<dim> &, std::size_t, const FrozenPoint &,           \
      const LocalSolution<dim> &, double, double);                             \
  template std::array<double, dim> frozen_velocity<dim>(                       \
      const OneStepProblem<dim> &, std::size_t, const FrozenPoint &,           \
      const std::array<double, dim> &);                                        \
  template LinearPoint<dim> linear_point<dim>(const OneStepProblem<dim> &,     \
                                              std::size_t, double, double);    \
  template bool has_frozen_law<dim>(const OneStepProblem<dim> &, std::size_t); \
  template double point_strength<dim>(const OneStepProblem<dim> &,             \
                                      std::size_t);                            \
  template double sliding_speed<dim>(const OneStepProblem<dim> &, std::size_t, \
                                     const std::array<double, dim> &);         \
  template Reach reach_of<dim>(const Interaction &, const double *);           \
  template double effective_opening<dim>(const Interaction &, const double *)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
