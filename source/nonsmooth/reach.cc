#include "damage.h"
#include "springs.h"

namespace nsfd
{
  using springs::positive;
  using springs::square;

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
    if (interaction.law && interaction.law->adds_openings())
      return positive(jump[0]) + std::sqrt(interaction.shear_weight * slip);
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
  double effective_traction(const OneStepProblem<dim> &problem,
                            const std::size_t i, const double normal,
                            const double *shear)
  {
    return PointDamage<dim>(problem, i).effective_traction(normal, shear);
  }

#define INSTANTIATE(dim)                                                       \
  template double point_strength<dim>(const OneStepProblem<dim> &,             \
                                      std::size_t);                            \
  template double effective_traction<dim>(                                     \
      const OneStepProblem<dim> &, std::size_t, double, const double *);       \
  template double sliding_speed<dim>(const OneStepProblem<dim> &, std::size_t, \
                                     const std::array<double, dim> &);         \
  template Reach reach_of<dim>(const Interaction &, const double *);           \
  template double effective_opening<dim>(const Interaction &, const double *)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
