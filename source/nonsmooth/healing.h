#pragma once

#include "one_step_problem.h"

#include "nsfd/cohesive_laws/law_point.h"

#include <algorithm>

namespace nsfd
{
  /**
   * What a pressed point gains in a time. The new bonds hold where the faces
   * are now: of the slip s that is left between them as much stays as keeps the
   * traction of the old ones, s' = s b/b' with their secants b < b'. What is
   * stored falls by that, and is dissipated; so is the surface energy, which
   * the line of the damage already has and which the next separation takes
   * again.
   */
  struct Healing {
    bool heals = false;
    double opening_max = 0.; ///< d_m after it
    double beta = 0.;
    double slip_share = 1.; ///< of the slip that stays
    double dissipated = 0.; ///< J per area, not negative
  };

  /** The law of the point does such a thing. */
  template <int dim>
  bool may_heal(const OneStepProblem<dim> &problem, const std::size_t i)
  {
    const auto &law = problem.interactions[problem.interaction[i]].law;
    return law && law->heals();
  }

  /** Some law does. */
  template <int dim>
  bool has_healing(const OneStepProblem<dim> &problem)
  {
    return std::any_of(problem.interactions.begin(), problem.interactions.end(),
                       [](const Interaction &interaction) {
                         return interaction.law && interaction.law->heals();
                       });
  }

  /**
   * Of a point that has @p beta left of the largest opening @p opening_max, at
   * the jump @p jump, pressed by @p pressure in Pa for @p time. Nothing heals
   * where it is open.
   */
  template <int dim>
  Healing healing_of(const OneStepProblem<dim> &problem, std::size_t i,
                     double beta, double opening_max, const double *jump,
                     double pressure, double time);

  /** J per area at the slip of @p jump, of what is not open. */
  template <int dim>
  double stored_by_law(const OneStepProblem<dim> &problem, std::size_t i,
                       double beta, double opening_max, const double *jump);

  /** @p jump does not damage what has healed. */
  template <int dim>
  bool is_within(const OneStepProblem<dim> &problem, std::size_t i,
                 const Healing &healing, const double *jump);
} // namespace nsfd
