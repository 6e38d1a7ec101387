#include "nsfd/nonsmooth/point_law.h"

#include "nsfd/input/scene_input.h"
#include "nsfd/interface/friction_weight.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();

    double square(const double x) { return x * x; }
    double positive(const double x) { return x > 0. ? x : 0.; }
    double negative(const double x) { return x < 0. ? x : 0.; }

    /**
     * Normal cohesive traction as a function of the normal velocity at fixed
     * secant b and compression stiffness c. End rules see x = x0 + s U; the
     * exact rule is the difference quotient of the potential
     * b <u>_+^2/2 + c <-u>_+^2/2 between u_k and u' = x0 + s U.
     */
    struct NormalSpring
    {
      double tension, compression; // b, c
      double offset, slope;        // x0, s
      double old;                  // u_k
      bool exact;

      double at(const double velocity) const
      {
        const double x = offset + slope * velocity;
        if (!exact)
          return tension * positive(x) + compression * negative(x);
        if (x >= 0. && old >= 0.)
          return tension * (x + old) / 2.;
        if (x <= 0. && old <= 0.)
          return compression * (x + old) / 2.;
        return (tension * (square(positive(x)) - square(positive(old))) +
                compression * (square(negative(x)) - square(negative(old)))) /
               (2. * (x - old));
      }

      /** dR/dU at @p velocity, from the side of the piece it lies in. */
      double derivative(const double velocity) const
      {
        const double x = offset + slope * velocity;
        const double mine = x > 0. ? tension : compression;
        if (!exact)
          return mine * slope;
        if (tension == compression)
          return mine * slope / 2.; // linear: the same bits at every velocity
        const double other = old > 0. ? tension : compression;
        if (x * old >= 0.)
          return (x == 0. ? other : mine) * slope / 2.;
        const double jump = x - old;
        return slope * (mine * (x * x - 2. * x * old) + other * old * old) /
               (2. * jump * jump);
      }

      /** U - U_loc + a R(U) = 0, a >= 0: one root, R is monotone. */
      double solve(const double local, const double a) const
      {
        if (tension == 0. && compression == 0.)
          return local;
        const double at_zero = -offset / slope; // the velocity with x = 0
        const bool opens = at_zero - local + a * at(at_zero) < 0.;
        const double mine = opens ? tension : compression;
        const double x_local = offset + slope * local;
        if (!exact)
          return (x_local / (1. + a * mine * slope) - offset) / slope;
        const double other = old > 0. ? tension : compression;
        const double k = a * slope;
        double x;
        if ((opens && old >= 0.) || (!opens && old <= 0.))
          x = (x_local - k * mine * old / 2.) / (1. + k * mine / 2.);
        else {
          // 2 (x - x_local)(x - old) + k (mine x^2 - other old^2) = 0
          const double p = 2. + k * mine, q = -2. * (x_local + old),
                       r = 2. * x_local * old - k * other * old * old;
          const double root = std::sqrt(std::max(0., q * q - 4. * p * r));
          // the root on the other side of zero than u_k
          const double t = -(q + std::copysign(root, q)) / 2.;
          const double first = t / p, second = t == 0. ? 0. : r / t;
          x = opens ? std::max(first, second) : std::min(first, second);
        }
        return (x - offset) / slope;
      }

      /** U with R(U) = traction; where no traction is possible: no root. */
      double inverse(const double traction) const
      {
        // R is continuous; x = 0 separates the pieces
        const double at_zero = at(-offset / slope);
        const bool opens = traction > at_zero;
        const double mine = opens ? tension : compression;
        double x;
        if (!exact)
          x = mine > 0. ? traction / mine : (opens ? infinity : -infinity);
        else {
          const double other = old > 0. ? tension : compression;
          if ((opens && old >= 0.) || (!opens && old <= 0.))
            x = mine > 0. ? 2. * traction / mine - old
                          : (opens ? infinity : -infinity);
          else {
            // mine x^2 - 2 R x + 2 R old - other old^2 = 0
            const double r = 2. * traction * old - other * old * old;
            if (mine > 0.) {
              const double root =
                std::sqrt(std::max(0., square(traction) - mine * r));
              x = (traction + (opens ? root : -root)) / mine;
            } else // a traction that only tends to zero
              x = (opens ? traction < 0. : traction > 0.)
                    ? r / (2. * traction)
                    : (opens ? infinity : -infinity);
          }
        }
        return (x - offset) / slope;
      }
    };

    /**
     * The spring and a traction eta <U_theta>_+ = c <U - U_0>_+ next to it,
     * with c = eta theta and U_0 = -U_k (1-theta)/theta.
     */
    struct NormalLaw
    {
      NormalSpring spring;
      double viscosity, start; // c, U_0

      /** No velocity is asked for by @p traction: all up to U_0 have it. */
      bool is_flat(const double traction) const
      {
        return spring.tension == 0. && spring.compression == 0. &&
               (viscosity == 0. || traction <= 0.);
      }

      bool drags(const double velocity) const
      {
        return viscosity > 0. && velocity > start;
      }

      double at(const double velocity) const
      {
        return drags(velocity)
                 ? spring.at(velocity) + viscosity * (velocity - start)
                 : spring.at(velocity);
      }

      double derivative(const double velocity) const
      {
        return drags(velocity) ? spring.derivative(velocity) + viscosity
                               : spring.derivative(velocity);
      }

      /** U - U_loc + a R(U) = 0, a >= 0. */
      double solve(const double local, const double a) const
      {
        if (viscosity == 0. || start - local + a * spring.at(start) >= 0.)
          return spring.solve(local, a);
        const double share = a * viscosity, factor = 1. + share;
        return spring.solve((local + share * start) / factor, a / factor);
      }

      /** U with R(U) = traction. */
      double inverse(const double traction) const
      {
        if (viscosity == 0.)
          return spring.inverse(traction);
        return traction > spring.at(start)
                 ? spring.solve(start + traction / viscosity, 1. / viscosity)
                 : spring.inverse(traction);
      }
    };

    /** Tangential cohesive traction b tau (y0 + s U_T), per component. */
    struct TangentialSpring
    {
      double stiffness, slope;
    };

    template <int dim>
    double velocity_slope(const OneStepProblem<dim> &problem)
    {
      return problem.rule == CohesionRule::end_velocity
               ? problem.time_step
               : problem.time_step * problem.theta;
    }

    template <int dim>
    NormalSpring normal_spring(const OneStepProblem<dim> &problem,
                               const std::size_t i,
                               const double secant)
    {
      const double old = problem.jump_old[i * dim];
      return {secant,
              problem.compression_stiffness[i],
              problem.rule == CohesionRule::end_velocity
                ? old
                : problem.jump_free[i * dim],
              velocity_slope(problem),
              old,
              problem.rule == CohesionRule::exact};
    }

    template <int dim>
    NormalLaw normal_law(const OneStepProblem<dim> &problem,
                         const std::size_t i,
                         const double secant)
    {
      const NormalSpring spring = normal_spring<dim>(problem, i, secant);
      if (problem.viscosity.empty() || problem.viscosity[i] == 0.)
        return {spring, 0., 0.};
      return {spring, problem.viscosity[i] * problem.theta,
              (problem.jump_old[i * dim] - problem.jump_free[i * dim]) /
                (problem.time_step * problem.theta)};
    }

    /** y0 of the tangential spring R_T = b tau (y0 + s U_T). */
    template <int dim>
    double tangential_offset(const OneStepProblem<dim> &problem,
                             const std::size_t i,
                             const unsigned int c)
    {
      const double old = problem.jump_old[i * dim + c],
                   end = problem.jump_free[i * dim + c];
      switch (problem.rule) {
      case CohesionRule::exact: return (old + end) / 2.;
      case CohesionRule::end_velocity: return old;
      default: return end;
      }
    }

    template <int dim>
    TangentialSpring tangential_spring(const OneStepProblem<dim> &problem,
                                       const std::size_t i,
                                       const double secant)
    {
      const auto &interaction =
        problem.interactions[problem.interaction[i]];
      const double slope = problem.rule == CohesionRule::exact
                             ? velocity_slope(problem) / 2.
                             : velocity_slope(problem);
      return {secant * interaction.stiffness_ratio, slope};
    }

    template <int dim>
    double end_opening(const OneStepProblem<dim> &problem,
                       const std::size_t i,
                       const std::array<double, dim> &velocity)
    {
      double jump[dim];
      for (unsigned int c = 0; c < dim; ++c)
        jump[c] = problem.jump_free[i * dim + c] +
                  problem.time_step * problem.theta * velocity[c];
      return effective_opening<dim>(
        problem.interactions[problem.interaction[i]], jump);
    }

    /** Strength and opening factors of a point: T(d) = a T_0(l d). */
    struct Scaling
    {
      double a, l;

      double secant(const CohesiveLaw &law, const double opening) const
      {
        return a * l * law.secant(l * opening);
      }
    };

    template <int dim>
    Scaling scaling_of(const OneStepProblem<dim> &problem, const std::size_t i)
    {
      return {problem.strength_factor[i], problem.opening_factor[i]};
    }

    /**
     * b for the opening d' at the end of the step. The exact rule takes the
     * change of stored plus dissipated potential over the change of d^2/2:
     * its work over the step is then that change.
     */
    template <int dim>
    double secant_for(const OneStepProblem<dim> &problem,
                      const std::size_t i,
                      const double opening)
    {
      const auto &interaction =
        problem.interactions[problem.interaction[i]];
      const auto &law = *interaction.law;
      const Scaling scaling = scaling_of<dim>(problem, i);
      const double d_m = problem.opening_max[i];
      if (opening <= d_m)
        return scaling.secant(law, d_m);
      if (problem.rule != CohesionRule::exact)
        return scaling.secant(law, opening);
      const double d =
        effective_opening<dim>(interaction, &problem.jump_old[i * dim]);
      // d <= d_m but for round-off, which must not reach a small difference
      const bool unloads = d < d_m * (1. - 2e-15);
      const double start = unloads ? d_m : std::max(d, d_m);
      if (opening <= start)
        return scaling.secant(law, start);
      const double unloaded =
        unloads ? scaling.secant(law, d_m) * (d_m - d) * (d_m + d) : 0.;
      // mean traction times the way: the way must not suffer from the scaling
      const double s0 = scaling.l * start, s1 = scaling.l * opening;
      const double mean = s1 > s0
                            ? law.energy_increment(s0, s1) / (s1 - s0)
                            : law.traction(s0);
      return (unloaded + 2. * scaling.a * mean * (opening - start)) /
             ((opening - d) * (opening + d));
    }

    template <int dim>
    double threshold_for(const OneStepProblem<dim> &problem,
                         const std::size_t i,
                         const double opening,
                         const double contact_impulse)
    {
      const auto &interaction =
        problem.interactions[problem.interaction[i]];
      if (interaction.friction == 0. || contact_impulse <= 0.)
        return 0.;
      const double end = std::max(opening, problem.opening_max[i]);
      // a rigid point that lets go in this step is damaged already
      const double beta =
        problem.kind[i] == PointKind::rigid
          ? interaction.law->beta(problem.opening_factor[i] * end)
          : beta_of(interaction, problem.kind[i], problem.opening_factor[i],
                    end);
      return interaction.friction *
             kappa(beta, interaction.friction_exponent) *
             contact_impulse;
    }

    template <int dim>
    void solve_normal(const OneStepProblem<dim> &problem,
                      const std::size_t i,
                      const double secant,
                      const double local,
                      const double majorant,
                      LocalSolution<dim> &solution)
    {
      const NormalLaw law = normal_law<dim>(problem, i, secant);
      const double wh = problem.weight[i] * problem.time_step;
      double U = law.solve(local, majorant * wh);
      solution.contact_impulse = 0.;
      if (problem.contact[i] && U < problem.target[i]) {
        U = problem.target[i];
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
                          const std::size_t i,
                          const double secant,
                          const double threshold,
                          const std::array<double, dim> &local,
                          const double majorant,
                          LocalSolution<dim> &solution)
    {
      const TangentialSpring spring = tangential_spring<dim>(problem, i, secant);
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
      const double bound = majorant * threshold;
      const double share = norm > bound ? (1. - bound / norm) / factor : 0.;
      for (unsigned int c = 1; c < dim; ++c) {
        const double U =
          share * z[c] - problem.sliding_offset[i * dim + c];
        solution.velocity[c] = U;
        solution.impulse[c] =
          threshold == 0. && factor < 2.
            ? -k * (tangential_offset<dim>(problem, i, c) + spring.slope * U)
            : (U - local[c]) / majorant;
      }
      if (solution.status == PointStatus::stick && share > 0.)
        solution.status = PointStatus::slide;
    }

    template <int dim>
    LocalSolution<dim>
    solve_prescribed(const OneStepProblem<dim> &problem,
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
      solution.frozen.secant = infinity;
      return solution;
    }

    /** U = 0 held by a traction below the strength? Compression always is. */
    template <int dim>
    bool stays_rigid(const OneStepProblem<dim> &problem,
                     const std::size_t i,
                     const std::array<double, dim> &impulse)
    {
      const auto &interaction =
        problem.interactions[problem.interaction[i]];
      const double wh = problem.weight[i] * problem.time_step;
      const double r2 = interaction.shear_weight;
      double traction = square(positive(-impulse[0]));
      for (unsigned int c = 1; c < dim; ++c)
        traction += r2 > 0. ? square(impulse[c]) / r2 : 0.;
      return std::sqrt(traction) <= wh * problem.strength_factor[i] *
                                      interaction.law->strength();
    }

    /**
     * Root of decreasing-at-the-ends @p f in [low, high], f(low) >= 0 >=
     * f(high): regula falsi with the Illinois change, bisection as the guard.
     */
    template <typename Function>
    double bracketed_root(const Function &f,
                          double low,
                          double high,
                          double f_low,
                          double f_high)
    {
      int side = 0;
      for (unsigned int k = 0; k < 200; ++k) {
        if (high - low <= 4e-16 * high || f_low == 0.)
          break;
        double middle = (low * f_high - high * f_low) / (f_high - f_low);
        if (!(middle > low && middle < high) || k % 4 == 3)
          middle = 0.5 * (low + high);
        const double value = f(middle);
        if (value == 0.)
          return middle;
        if (value > 0.) {
          low = middle;
          f_low = value;
          if (side == 1)
            f_high /= 2.;
          side = 1;
        } else {
          high = middle;
          f_high = value;
          if (side == -1)
            f_low /= 2.;
          side = -1;
        }
      }
      return f_low == 0. ? low : 0.5 * (low + high);
    }

    /**
     * Where a law jumps, friction sets in at once, and the root of the local
     * problem can be the jump itself: with a secant and a threshold between
     * those of its two sides the step ends at just this opening.
     */
    template <int dim>
    void solve_between(const OneStepProblem<dim> &problem,
                       const std::size_t i,
                       const FrozenPoint before,
                       const FrozenPoint after,
                       const double opening,
                       const std::array<double, dim> &local,
                       const double majorant_normal,
                       const double majorant_tangential,
                       LocalSolution<dim> &solution)
    {
      const auto excess = [&](const double share) {
        solution.frozen = {
          before.secant + share * (after.secant - before.secant),
          before.threshold + share * (after.threshold - before.threshold)};
        solve_normal<dim>(problem, i, solution.frozen.secant, local[0],
                          majorant_normal, solution);
        solve_tangential<dim>(problem, i, solution.frozen.secant,
                              solution.frozen.threshold, local,
                              majorant_tangential, solution);
        return end_opening<dim>(problem, i, solution.velocity) - opening;
      };
      const double f_before = excess(0.), f_after = excess(1.);
      excess(bracketed_root(excess, 0., 1., f_before, f_after));
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
    for (auto *array : {&strength_factor, &opening_factor})
      array->assign(n, 1.);
    for (auto *array : {&free_velocity, &given_velocity, &jump_old, &jump_free,
                        &sliding_offset})
      array->assign(n * dim, 0.);
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

  double beta_of(const Interaction &interaction,
                 const PointKind kind,
                 const double opening_factor,
                 const double opening_max)
  {
    switch (kind) {
    case PointKind::free: return 0.;
    case PointKind::cohesive:
      return interaction.law->beta(opening_factor * opening_max);
    default: return 1.;
    }
  }

  template <int dim>
  LocalSolution<dim>
  solve_frozen_point(const OneStepProblem<dim> &problem,
                     const std::size_t i,
                     const FrozenPoint &frozen,
                     const std::array<double, dim> &local,
                     const double majorant_normal,
                     const double majorant_tangential)
  {
    if (problem.kind[i] == PointKind::prescribed)
      return solve_prescribed<dim>(problem, i, local, majorant_normal,
                              majorant_tangential);
    LocalSolution<dim> solution;
    if (std::isinf(frozen.secant)) {
      solution.status = PointStatus::prescribed;
      for (unsigned int c = 0; c < dim; ++c)
        solution.impulse[c] =
          -local[c] / (c == 0 ? majorant_normal : majorant_tangential);
    } else {
      solve_normal<dim>(problem, i, frozen.secant, local[0], majorant_normal,
                   solution);
      solve_tangential<dim>(problem, i, frozen.secant, frozen.threshold, local,
                       majorant_tangential, solution);
    }
    solution.frozen = frozen;
    solution.opening = end_opening<dim>(problem, i, solution.velocity);
    return solution;
  }

  template <int dim>
  LocalSolution<dim> solve_point(const OneStepProblem<dim> &problem,
                                 const std::size_t i,
                                 const std::array<double, dim> &local,
                                 const double majorant_normal,
                                 const double majorant_tangential,
                                 const double opening_start)
  {
    const PointKind kind = problem.kind[i];
    if (kind == PointKind::prescribed)
      return solve_prescribed<dim>(problem, i, local, majorant_normal,
                              majorant_tangential);

    const auto &interaction = problem.interactions[problem.interaction[i]];
    LocalSolution<dim> solution, held;
    // everything at a given secant; friction follows the normal part at once
    const auto solve_at = [&](const double secant, const double opening) {
      solve_normal<dim>(problem, i, secant, local[0], majorant_normal, solution);
      solution.frozen = {
        secant, threshold_for<dim>(problem, i, opening, solution.contact_impulse)};
      solve_tangential<dim>(problem, i, secant, solution.frozen.threshold, local,
                       majorant_tangential, solution);
      solution.opening = end_opening<dim>(problem, i, solution.velocity);
    };

    if (kind == PointKind::free || kind == PointKind::elastic) {
      solve_at(kind == PointKind::elastic ? interaction.normal_stiffness : 0.,
               0.);
      return solution;
    }

    const double d_m = problem.opening_max[i];
    double low = d_m;
    if (kind == PointKind::rigid) {
      held.status = PointStatus::prescribed;
      for (unsigned int c = 0; c < dim; ++c)
        held.impulse[c] =
          -local[c] / (c == 0 ? majorant_normal : majorant_tangential);
      held.frozen.secant = infinity;
      if (stays_rigid<dim>(problem, i, held.impulse))
        return held;
      low = 0.;
    } else {
      solve_at(secant_for<dim>(problem, i, d_m), d_m);
      if (solution.opening <= d_m)
        return solution;
    }

    // Damage grows: d' = d(u'(b(d'))) between d_m and the opening without
    // cohesion; move from the start to the adjacent root.
    solve_at(0., low);
    const double high = std::max(solution.opening, low);
    const auto excess = [&](const double opening) {
      solve_at(secant_for<dim>(problem, i, opening), opening);
      return solution.opening - opening;
    };
    if (kind == PointKind::rigid) {
      if (high == 0.) // friction alone holds it
        return held;
      low = 1e-9 * high;
    }
    double a = low, b = high, f_a = excess(a), f_b = excess(b);
    // a spring that is crossed (u and u' on both sides) may push further
    for (unsigned int k = 0; k < 60 && f_b > 0.; ++k)
      f_b = excess(b *= 2.);
    // friction with kappa(1) > 0 may hold what the strength alone does not
    if (kind == PointKind::rigid && f_a <= 0.)
      return held;
    if (f_a <= 0.)
      b = a, f_b = 0.;
    else if (opening_start > a && opening_start < b) {
      const double f = excess(opening_start);
      (f > 0. ? a : b) = opening_start;
      (f > 0. ? f_a : f_b) = f;
    }
    const double root =
      f_b >= 0. ? b : bracketed_root(excess, a, b, f_a, f_b);
    if (std::abs(excess(root)) > 1e-9 * root) {
      excess(root * (1. - 1e-15));
      const FrozenPoint before = solution.frozen;
      excess(root * (1. + 1e-15));
      solve_between<dim>(problem, i, before, solution.frozen, root, local,
                         majorant_normal, majorant_tangential, solution);
    }
    solution.opening = root;
    solution.damages = true;
    return solution;
  }

  template <int dim>
  std::array<double, dim>
  frozen_slopes(const OneStepProblem<dim> &problem,
                const std::size_t i,
                const FrozenPoint &frozen,
                const LocalSolution<dim> &solution,
                const double majorant_normal,
                const double majorant_tangential)
  {
    std::array<double, dim> slopes{};
    if (problem.kind[i] == PointKind::prescribed) {
      for (unsigned int c = 0; c < dim; ++c)
        if (problem.mask[i] & (1u << c))
          slopes[c] = 1. / (c == 0 ? majorant_normal : majorant_tangential);
      return slopes;
    }
    if (std::isinf(frozen.secant)) {
      for (unsigned int c = 0; c < dim; ++c)
        slopes[c] = 1. / (c == 0 ? majorant_normal : majorant_tangential);
      return slopes;
    }
    const double wh = problem.weight[i] * problem.time_step;
    if (solution.status == PointStatus::open) {
      const double k =
        wh * normal_law<dim>(problem, i, frozen.secant)
               .derivative(solution.velocity[0]);
      slopes[0] = k / (1. + majorant_normal * k);
    } else
      slopes[0] = 1. / majorant_normal;

    const TangentialSpring spring =
      tangential_spring<dim>(problem, i, frozen.secant);
    const double k = wh * spring.stiffness * spring.slope;
    double sliding = 0.;
    for (unsigned int c = 1; c < dim; ++c)
      sliding += square(solution.velocity[c] +
                        problem.sliding_offset[i * dim + c]);
    sliding = std::sqrt(sliding);
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
  frozen_velocity(const OneStepProblem<dim> &problem,
                  const std::size_t i,
                  const FrozenPoint &frozen,
                  const std::array<double, dim> &impulse)
  {
    std::array<double, dim> velocity{};
    if (problem.kind[i] == PointKind::prescribed) {
      for (unsigned int c = 0; c < dim; ++c)
        velocity[c] = problem.given_velocity[i * dim + c];
      return velocity;
    }
    if (std::isinf(frozen.secant))
      return velocity;
    const double wh = problem.weight[i] * problem.time_step;
    const NormalLaw normal = normal_law<dim>(problem, i, frozen.secant);
    const double target =
      problem.contact[i] ? problem.target[i] : -infinity;
    const double traction = -impulse[0] / wh;
    if (normal.is_flat(traction))
      velocity[0] = problem.contact[i] ? target : normal.start;
    else
      velocity[0] = std::max(target, normal.inverse(traction));

    const TangentialSpring spring =
      tangential_spring<dim>(problem, i, frozen.secant);
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
  PointEnergies<dim>
  point_energies(const OneStepProblem<dim> &problem,
                 const std::size_t i,
                 const std::array<double, dim> &velocity,
                 const FrozenPoint &frozen)
  {
    PointEnergies<dim> result;
    const PointKind kind = problem.kind[i];
    result.opening_max = problem.opening_max[i];
    if (kind == PointKind::prescribed)
      return result;
    const auto &interaction = problem.interactions[problem.interaction[i]];
    const Scaling scaling = scaling_of<dim>(problem, i);
    const double compression = problem.compression_stiffness[i];
    double jump[dim];
    const double *old = &problem.jump_old[i * dim];
    for (unsigned int c = 0; c < dim; ++c)
      jump[c] = problem.jump_free[i * dim + c] +
                problem.time_step * problem.theta * velocity[c];
    if (kind == PointKind::free) {
      result.beta = 0.;
      return result;
    }
    const auto spring_energy = [&](const double b, const double *u) {
      double slip = 0.;
      for (unsigned int c = 1; c < dim; ++c)
        slip += square(u[c]);
      return (b * (square(positive(u[0])) +
                   interaction.stiffness_ratio * slip) +
              compression * square(negative(u[0]))) /
             2.;
    };
    const auto traction = [&](const double b) {
      const NormalLaw normal = normal_law<dim>(problem, i, b);
      result.cohesive_traction[0] = normal.at(velocity[0]);
      // eta <U_theta>_+ U_theta h
      if (normal.drags(velocity[0])) {
        const double speed = problem.theta * (velocity[0] - normal.start);
        result.viscous_traction = problem.viscosity[i] * speed;
        result.viscous =
          result.viscous_traction * speed * problem.time_step;
      }
      const TangentialSpring spring = tangential_spring<dim>(problem, i, b);
      for (unsigned int c = 1; c < dim; ++c)
        result.cohesive_traction[c] =
          spring.stiffness *
          (tangential_offset<dim>(problem, i, c) + spring.slope * velocity[c]);
    };
    if (kind == PointKind::elastic) {
      const double C = interaction.normal_stiffness;
      traction(C);
      result.stored = spring_energy(C, jump);
      result.stored_old = spring_energy(C, old);
      return result;
    }

    const auto &law = *interaction.law;
    const double d_m = problem.opening_max[i];
    if (kind == PointKind::rigid && std::isinf(frozen.secant))
      return result;
    const double opening = effective_opening<dim>(interaction, jump);
    result.opening_max = std::max(d_m, opening);
    traction(problem.rule == CohesionRule::exact
               ? secant_for<dim>(problem, i, opening)
               : frozen.secant);

    const bool was_rigid = kind == PointKind::rigid;
    const double b_old = was_rigid ? 0. : scaling.secant(law, d_m),
                 b_new = scaling.secant(law, result.opening_max);
    result.beta = law.beta(scaling.l * result.opening_max);
    result.stored = spring_energy(b_new, jump);
    result.stored_old = was_rigid ? 0. : spring_energy(b_old, old);
    if (result.opening_max > d_m) {
      const double released =
        scaling.a / scaling.l *
        law.energy_increment(scaling.l * d_m, scaling.l * result.opening_max);
      if (law.has_potential())
        result.damage =
          std::max(0., released - (b_new * square(result.opening_max) -
                                   b_old * square(d_m)) /
                                    2.);
      else {
        // no potential: the mean driving force times the loss of beta
        const double C = scaling.a * scaling.l * law.normal_stiffness();
        result.damage = std::max(
          0., (b_old - b_new) / C *
                (spring_energy(C, old) + spring_energy(C, jump)) / 2.);
      }
    }
    if (result.beta < 1. && compression > 0.) {
      result.overlap_released = compression * square(negative(jump[0])) / 2.;
      result.stored -= result.overlap_released;
    }
    return result;
  }

  template <int dim>
  FrozenPoint frozen_state(const OneStepProblem<dim> &problem,
                           const std::size_t i,
                           const double opening,
                           const double contact_impulse)
  {
    FrozenPoint frozen;
    switch (problem.kind[i]) {
    case PointKind::prescribed: frozen.secant = infinity; return frozen;
    case PointKind::free: break;
    case PointKind::elastic:
      frozen.secant =
        problem.interactions[problem.interaction[i]].normal_stiffness;
      break;
    case PointKind::rigid: return frozen; // has no secant before it opens
    case PointKind::cohesive:
      frozen.secant = secant_for<dim>(problem, i, opening);
      break;
    }
    frozen.threshold = threshold_for<dim>(problem, i, opening, contact_impulse);
    return frozen;
  }

#define INSTANTIATE(dim)                                                       \
  template FrozenPoint frozen_state<dim>(const OneStepProblem<dim> &,          \
                                         std::size_t, double, double);         \
  template struct OneStepProblem<dim>;                                         \
  template LocalSolution<dim> solve_point<dim>(                                \
    const OneStepProblem<dim> &, std::size_t,                                  \
    const std::array<double, dim> &, double, double, double);                  \
  template LocalSolution<dim> solve_frozen_point<dim>(                         \
    const OneStepProblem<dim> &, std::size_t, const FrozenPoint &,             \
    const std::array<double, dim> &, double, double);                          \
  template std::array<double, dim> frozen_slopes<dim>(                         \
    const OneStepProblem<dim> &, std::size_t, const FrozenPoint &,             \
    const LocalSolution<dim> &, double, double);                               \
  template std::array<double, dim> frozen_velocity<dim>(                       \
    const OneStepProblem<dim> &, std::size_t, const FrozenPoint &,             \
    const std::array<double, dim> &);                                          \
  template PointEnergies<dim> point_energies<dim>(                             \
    const OneStepProblem<dim> &, std::size_t,                                  \
    const std::array<double, dim> &, const FrozenPoint &);                     \
  template double effective_opening<dim>(const Interaction &, const double *)

  INSTANTIATE(2);
  INSTANTIATE(3);
} // namespace nsfd
