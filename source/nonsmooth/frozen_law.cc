#include "local_problem.h"

namespace nsfd
{
  using namespace local;

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
    case PointKind::separated:
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
    frozen.threshold = threshold_for(problem, i, beta, contact_impulse);
    return frozen;
  }

#define INSTANTIATE(dim)                                                       \
  template std::array<double, dim> frozen_slopes<dim>(                         \
      const OneStepProblem<dim> &, std::size_t, const FrozenPoint &,           \
      const LocalSolution<dim> &, double, double);                             \
  template std::array<double, dim> frozen_velocity<dim>(                       \
      const OneStepProblem<dim> &, std::size_t, const FrozenPoint &,           \
      const std::array<double, dim> &);                                        \
  template FrozenPoint frozen_state<dim>(const OneStepProblem<dim> &,          \
                                         std::size_t, const Reach &, double)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
