#include "damage.h"

#include "nsfd/scene/time_input.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    constexpr double no_jump[3] = {};
  } // namespace

  LawPoint law_at(const Interaction &interaction, const double strength,
                  const double opening)
  {
    return LawPoint(*interaction.law, strength, opening, interaction.plateau,
                    interaction.stiffness_ratio, interaction.shear_weight);
  }

  template <int dim>
  PointDamage<dim>::PointDamage(const OneStepProblem<dim> &problem,
                                const std::size_t point)
      : interaction_(problem.interactions[problem.interaction[point]]),
        friction_(friction_of(problem, point)),
        law_(law_at(interaction_, problem.strength_factor[point],
                    problem.opening_factor[point])),
        history_{problem.opening_max[point],
                 interaction_.law->mixed() ? problem.slip_max[point] : 0.},
        old_(problem.from_closed ? no_jump : &problem.jump_old[point * dim]),
        rule_(problem.rule),
        // of the step alone, without the way to u_k
        time_step_(problem.from_closed ? problem.time_step * problem.theta
                                       : problem.time_step)
  {
  }

  template <int dim>
  Reach PointDamage<dim>::reach(const double *u) const
  {
    return law_.reach(JumpSize::of<dim>(u));
  }

  template <int dim>
  Reach PointDamage<dim>::history_after(const Reach &end) const
  {
    return law_.history_after(history_, end, time_step_);
  }

  template <int dim>
  Secant PointDamage<dim>::secant(const Reach &end) const
  {
    if (rule_ == CohesionRule::exact)
      return law_.mean_secant({reach(old_), history_},
                              {end, history_after(end)});
    if (!plateau())
      return law_.secant(history_after(end));
    // set-valued at 0: any traction up to the plateau
    const double d_top = std::max(history_.opening, end.opening);
    const double least = 1e-12 * std::max(d_top, reach(old_).opening);
    const double b = law_.traction(d_top) / std::max(end.opening, least);
    return {b, b * interaction_.stiffness_ratio};
  }

  template <int dim>
  double PointDamage<dim>::mean_traction(const Reach &end) const
  {
    if (rule_ == CohesionRule::exact)
      return law_.mean_traction({reach(old_), history_}, end.opening);
    return law_.traction(std::max(history_.opening, end.opening));
  }

  template <int dim>
  Dissipation PointDamage<dim>::dissipation(const double *u) const
  {
    const LawState start{JumpSize::of<dim>(old_), history_};
    return law_.dissipated(start,
                           law_.moved(start, JumpSize::of<dim>(u), time_step_));
  }

  template class PointDamage<2>;
  template class PointDamage<3>;
} // namespace nsfd
