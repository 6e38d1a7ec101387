#pragma once

#include "delassus/delassus_operator.h"
#include "discretization/discretization.h"
#include "nonsmooth/one_step_problem.h"

#include <optional>
#include <vector>

namespace nsfd
{
  /**
   * How much of its strength every point carries that is rigidly joined and
   * extrinsic; 0 at all others, nothing if there is none on any rank.
   * Collective.
   */
  template <int dim>
  std::optional<std::vector<double>>
  strength_shares(const DelassusOperator<dim> &delassus,
                  const std::vector<PointOrigin> &origins,
                  const std::vector<double> &impulse,
                  const OneStepProblem<dim> &problem);

  /**
   * Activate rigidly joined extrinsic points whose traction exceeds the
   * strength: they take part in @p problem with their law. True if there was
   * one. Collective.
   */
  template <int dim>
  bool activate(const DelassusOperator<dim> &delassus,
                const std::vector<PointOrigin> &origins,
                const std::vector<double> &impulse,
                OneStepProblem<dim> &problem);
} // namespace nsfd
