#include "point_law.h"

#include "local_problem.h"

namespace nsfd
{
  using namespace local;

  namespace
  {
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
      return effective_traction<dim>(problem, i, -impulse[0],
                                     impulse.data() + 1) <=
             wh * point_strength<dim>(problem, i);
    }
  } // namespace

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
      result.is_linear = true;
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
    if (result.secant.normal != problem.compression_stiffness[i])
      return {};
    result.is_linear = true;
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

    if (kind == PointKind::free && !problem.contact[i] &&
        (problem.viscosity.empty() || problem.viscosity[i] == 0.)) {
      LocalSolution<dim> solution; // nothing acts
      solution.velocity = local;
      solution.frozen.secant = Secant{0., 0.};
      return solution;
    }

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
      if (damage.adds()) {
        solve_added<dim>(damage, start, here);
        if (solution.reach.opening == 0.)
          return held;
        solution.damages = true;
        return finish(true);
      }
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
    if (damage.adds()) {
      solve_added<dim>(damage, start, here);
      solution.damages = damage.grows(solution.reach);
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

#define INSTANTIATE(dim)                                                       \
  template LocalSolution<dim> solve_point<dim>(                                \
      const OneStepProblem<dim> &, std::size_t,                                \
      const std::array<double, dim> &, double, double, const Reach &);         \
  template LocalSolution<dim> solve_frozen_point<dim>(                         \
      const OneStepProblem<dim> &, std::size_t, const FrozenPoint &,           \
      const std::array<double, dim> &, double, double);                        \
  template LinearPoint<dim> linear_point<dim>(const OneStepProblem<dim> &,     \
                                              std::size_t, double, double);    \
  template bool has_frozen_law<dim>(const OneStepProblem<dim> &, std::size_t)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
