#include "healing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    template <int dim>
    LawPoint law_point(const OneStepProblem<dim> &problem, const std::size_t i)
    {
      const auto &interaction = problem.interactions[problem.interaction[i]];
      return LawPoint(*interaction.law, problem.strength_factor[i],
                      problem.opening_factor[i]);
    }
  } // namespace

  template <int dim>
  double stored_by_law(const OneStepProblem<dim> &problem, const std::size_t i,
                       const double beta, const double opening_max,
                       const double *jump)
  {
    if (beta <= 0.)
      return 0.;
    return law_point(problem, i)
        .stored({{0., JumpSize::of<dim>(jump).slip_square}, {opening_max, 0.}});
  }

  template <int dim>
  bool is_within(const OneStepProblem<dim> &problem, const std::size_t i,
                 const Healing &healing, const double *jump)
  {
    return healing.beta <= 0. ||
           law_point(problem, i).reach(JumpSize::of<dim>(jump)).opening <=
               healing.opening_max;
  }

  template <int dim>
  Healing healing_of(const OneStepProblem<dim> &problem, const std::size_t i,
                     const double beta, const double opening_max,
                     const double *jump, const double pressure,
                     const double time)
  {
    Healing result;
    const auto &interaction = problem.interactions[problem.interaction[i]];
    if (!may_heal(problem, i) || !(pressure > 0.) || beta >= 1.)
      return result;
    const CohesiveLaw &law = *interaction.law;
    const LawPoint point = law_point(problem, i);
    // round-off of a closed face is no opening
    if (jump[0] > 1e-9 * law.elastic_limit() / problem.opening_factor[i])
      return result;
    const Reach before = {
        beta > 0. ? opening_max : std::numeric_limits<double>::infinity(), 0.};
    const double l = problem.opening_factor[i];
    const Reach after = {
        law.healed_opening(l * before.opening, pressure, time) / l, 0.};
    if (!(after.opening < before.opening))
      return result;
    result.heals = true;
    result.opening_max = after.opening;
    result.beta = point.beta(after);
    const double square = JumpSize::of<dim>(jump).slip_square,
                 slip = std::sqrt(square * interaction.shear_weight);
    double stored = 0.;
    if (beta > 0.) {
      stored = point.stored({{0., square}, before});
      result.slip_share = std::min(1., point.secant(before).tangential /
                                           point.secant(after).tangential);
    } else
      result.slip_share = 0.;
    // not beyond what the healed law has been opened to
    if (result.slip_share * slip > after.opening)
      result.slip_share = after.opening / slip;
    const double left = square * result.slip_share * result.slip_share;
    result.dissipated =
        std::max(0., stored - point.stored({{0., left}, after}));
    return result;
  }

#define INSTANTIATE(dim)                                                       \
  template Healing healing_of<dim>(const OneStepProblem<dim> &, std::size_t,   \
                                   double, double, const double *, double,     \
                                   double);                                    \
  template double stored_by_law<dim>(const OneStepProblem<dim> &, std::size_t, \
                                     double, double, const double *);          \
  template bool is_within<dim>(const OneStepProblem<dim> &, std::size_t,       \
                               const Healing &, const double *)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
