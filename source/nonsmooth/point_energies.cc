#include "point_law.h"

#include "damage.h"
#include "springs.h"

namespace nsfd
{
  using namespace springs;

  namespace
  {
    /** (c <-u_N>_+^2) / 2 of the two-sided spring. */
    double overlap_energy(const double compression, const double u_N)
    {
      return compression * square(negative(u_N)) / 2.;
    }

    /** R_coh of the step at the given secants, and its viscous part. */
    template <int dim>
    void set_tractions(const OneStepProblem<dim> &problem, const std::size_t i,
                       const Secant &secant,
                       const std::array<double, dim> &velocity,
                       PointEnergies<dim> &result)
    {
      const NormalLaw normal = normal_law<dim>(problem, i, secant.normal);
      result.cohesive_traction[0] = normal.at(velocity[0]);
      if (normal.drags(velocity[0])) {
        const double speed = problem.theta * (velocity[0] - normal.start);
        result.viscous_traction = normal.drag(velocity[0]);
        result.viscous = result.viscous_traction * speed * problem.time_step;
      }
      const TangentialSpring spring =
          tangential_spring<dim>(problem, secant.tangential);
      for (unsigned int c = 1; c < dim; ++c)
        result.cohesive_traction[c] =
            spring.stiffness * (tangential_offset<dim>(problem, i, c) +
                                spring.slope * velocity[c]);
    }

    /** Of added openings. */
    template <int dim>
    void set_added_tractions(const OneStepProblem<dim> &problem,
                             const std::size_t i,
                             const PointDamage<dim> &damage,
                             const std::array<double, dim> &velocity,
                             PointEnergies<dim> &result)
    {
      const bool exact = problem.rule == CohesionRule::exact,
                 at_jump = problem.rule == CohesionRule::end_velocity;
      const double *start = damage.start();
      double jump[dim], end[dim], from = 0., to = 0.;
      for (unsigned int c = 0; c < dim; ++c) {
        jump[c] = problem.jump_free[i * dim + c] +
                  problem.time_step * problem.theta * velocity[c];
        end[c] = added_end(at_jump ? start[c] : problem.jump_free[i * dim + c],
                           velocity_slope<dim>(problem) * velocity[c]);
        if (c > 0) {
          from += square(start[c]);
          to += square(end[c]);
        }
      }
      const double m = damage.mean_traction(damage.reach(jump));
      result.cohesive_traction[0] =
          added_normal_traction(m, exact ? start[0] : 0., end[0]);
      // where a step ends at no slip, the quotient is that of its way
      const double share = exact || to == 0. ? 1. : 0.;
      const double size = share * std::sqrt(from) + std::sqrt(to);
      for (unsigned int c = 1; c < dim && size > 0.; ++c)
        result.cohesive_traction[c] =
            m * damage.slip_weight() * (share * start[c] + end[c]) / size;
    }

    template <int dim>
    double elastic_energy(const Interaction &interaction, const double *u)
    {
      double slip = 0.;
      for (unsigned int c = 1; c < dim; ++c)
        slip += square(u[c]);
      return interaction.normal_stiffness *
             (square(positive(u[0])) + interaction.stiffness_ratio * slip) / 2.;
    }
  } // namespace

  template <int dim>
  double stored_energy(const OneStepProblem<dim> &problem, const std::size_t i)
  {
    const double *u = &problem.jump_old[i * dim];
    const double overlap =
        overlap_energy(problem.compression_stiffness[i], u[0]);
    switch (problem.kind[i]) {
    case PointKind::elastic:
      return overlap + elastic_energy<dim>(
                           problem.interactions[problem.interaction[i]], u);
    case PointKind::cohesive: {
      const PointDamage<dim> damage(problem, i);
      return overlap + damage.stored(damage.history(), u);
    }
    default:
      return 0.;
    }
  }

  template <int dim>
  PointEnergies<dim> point_energies(const OneStepProblem<dim> &problem,
                                    const std::size_t i,
                                    const std::array<double, dim> &velocity,
                                    const FrozenPoint &frozen)
  {
    PointEnergies<dim> result;
    const PointKind kind = problem.kind[i];
    const auto &interaction = problem.interactions[problem.interaction[i]];
    result.history.opening = problem.opening_max[i];
    if (!problem.slip_max.empty())
      result.history.slip = problem.slip_max[i];
    if (kind == PointKind::prescribed ||
        (kind == PointKind::rigid && frozen.is_rigid()))
      return result;
    if (kind == PointKind::free) {
      result.beta = 0.;
      return result;
    }

    double jump[dim];
    for (unsigned int c = 0; c < dim; ++c)
      jump[c] = problem.jump_free[i * dim + c] +
                problem.time_step * problem.theta * velocity[c];
    const double compression = problem.compression_stiffness[i];
    const double overlap = overlap_energy(compression, jump[0]);
    result.stored = overlap;
    result.stored_old = stored_energy<dim>(problem, i);
    if (kind == PointKind::elastic) {
      const double C = interaction.normal_stiffness;
      set_tractions<dim>(problem, i, {C, C * interaction.stiffness_ratio},
                         velocity, result);
      result.stored += elastic_energy<dim>(interaction, jump);
      return result;
    }

    const PointDamage<dim> damage(problem, i);
    const Reach end = damage.reach(jump);
    if (damage.adds())
      set_added_tractions<dim>(problem, i, damage, velocity, result);
    else
      set_tractions<dim>(problem, i,
                         problem.rule == CohesionRule::exact && !frozen.held
                             ? damage.secant(end)
                             : frozen.secant,
                         velocity, result);
    result.history = damage.history_after(end);
    result.beta = damage.beta(result.history);
    result.stored += damage.stored(result.history, jump);
    const auto dissipation = damage.dissipation(jump);
    result.damage = dissipation.damage;
    result.viscous += dissipation.viscous;
    if (result.beta < 1. && compression > 0.) {
      result.overlap_released = overlap;
      result.stored -= overlap;
    }
    return result;
  }

#define INSTANTIATE(dim)                                                       \
  template double stored_energy<dim>(const OneStepProblem<dim> &,              \
                                     std::size_t);                             \
  template PointEnergies<dim> point_energies<dim>(                             \
      const OneStepProblem<dim> &, std::size_t,                                \
      const std::array<double, dim> &, const FrozenPoint &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
