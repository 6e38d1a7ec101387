#include "elastic_point.h"

#include "nonsmooth/damage.h"
#include "nonsmooth/springs.h"

#include <cmath>

namespace nsfd
{
  namespace
  {
    /** Below the history the law is a spring through the origin. */
    template <int dim>
    bool is_spring(const PointDamage<dim> &damage, const Secant &secant,
                   const double largest)
    {
      for (unsigned int c = 0; c < 2; ++c) {
        double u[dim] = {};
        u[c] = 0.5 * largest;
        const double k = c == 0 ? secant.normal : secant.tangential;
        const Secant here = damage.secant(damage.reach(u));
        const double energy = k * u[c] * u[c] / 2.;
        if (!(std::abs(damage.stored(damage.history(), u) - energy) <=
              1e-13 * energy) ||
            !(std::abs(here.normal - secant.normal) <= 1e-13 * secant.normal) ||
            !(std::abs(here.tangential - secant.tangential) <=
              1e-13 * secant.tangential))
          return false;
      }
      return true;
    }
  } // namespace

  template <int dim>
  bool ElasticPoint<dim>::reinit(const OneStepProblem<dim> &problem,
                                 const std::size_t i, const double present_beta)
  {
    const PointKind kind = problem.kind[i];
    const auto &interaction = problem.interactions[problem.interaction[i]];
    if (problem.rule == CohesionRule::end_velocity || problem.mask[i] != 0 ||
        (!problem.viscosity.empty() && problem.viscosity[i] > 0.))
      return false;
    beta = present_beta;
    if (interaction.law && interaction.law->heals() && beta < 1.)
      return false;
    one_sided = problem.compression_stiffness[i] == 0.;
    broken = kind == PointKind::free;
    if (broken) {
      largest = springs::infinity;
      rubs = interaction.friction > 0.;
      return one_sided;
    }
    holds = kind == PointKind::rigid;
    if (holds) {
      one_sided = rubs = false;
      largest = springs::infinity;
      surely_held = 0.;
      if (!interaction.law->mixed()) {
        double shear[dim] = {1.};
        const double largest_share = // of shear in what is compared
            std::max(1., effective_traction<dim>(problem, i, 0., shear));
        surely_held = springs::square(
            (1. - 1e-9) * point_strength<dim>(problem, i) * problem.weight[i] *
            problem.time_step / largest_share);
      }
      return true;
    }
    if (kind == PointKind::elastic) {
      const double k = interaction.normal_stiffness;
      secant = {k, k * interaction.stiffness_ratio};
      largest = springs::infinity;
    } else if (kind == PointKind::cohesive && !interaction.law->mixed() &&
               !interaction.plateau && problem.opening_max[i] > 0.) {
      const PointDamage<dim> damage(problem, i);
      secant = damage.secant({});
      if (!is_spring(damage, secant, problem.opening_max[i]))
        return false;
      largest = springs::square(problem.opening_max[i]);
    } else
      return false;
    const double compression = problem.compression_stiffness[i];
    rubs = interaction.friction > 0. &&
           (beta < 1. || interaction.friction_exponent == 0.);
    return secant.normal > 0. && secant.tangential > 0. &&
           (one_sided ||
            std::abs(compression - secant.normal) <= 1e-13 * secant.normal);
  }

  template <int dim>
  auto ElasticPoint<dim>::energies(const OneStepProblem<dim> &problem,
                                   const std::size_t i,
                                   const double *velocity) const -> Energies
  {
    Energies result;
    const double h_theta = problem.time_step * problem.theta;
    const double *before = &problem.jump_old[i * dim],
                 *end = &problem.jump_free[i * dim];
    std::array<double, 2> square;
    for (unsigned int k = 0; k < 2; ++k) {
      double slip = 0.,
             u_N = k == 0 ? before[0] : end[0] + h_theta * velocity[0];
      if (one_sided)
        u_N = springs::positive(u_N);
      for (unsigned int c = 1; c < dim; ++c)
        slip += springs::square(k == 0 ? before[c]
                                       : end[c] + h_theta * velocity[c]);
      square[k] = secant.normal * u_N * u_N + secant.tangential * slip;
    }
    result.stored_old = square[0] / 2.;
    result.stored = square[1] / 2.;
    result.traction[0] =
        springs::normal_spring<dim>(problem, i, secant.normal).at(velocity[0]);
    const auto spring =
        springs::tangential_spring<dim>(problem, secant.tangential);
    for (unsigned int c = 1; c < dim; ++c)
      result.traction[c] =
          spring.stiffness * (springs::tangential_offset<dim>(problem, i, c) +
                              spring.slope * velocity[c]);
    return result;
  }

  template <int dim>
  bool ElasticPoint<dim>::is_below_strength(const OneStepProblem<dim> &problem,
                                            const std::size_t i,
                                            const double *impulse) const
  {
    std::array<double, dim> pull;
    for (unsigned int c = 0; c < dim; ++c)
      pull[c] = -impulse[c];
    return effective_traction<dim>(problem, i, pull[0], &pull[1]) <=
           point_strength<dim>(problem, i) * problem.weight[i] *
               problem.time_step;
  }

  template struct ElasticPoint<2>;
  template struct ElasticPoint<3>;
} // namespace nsfd
