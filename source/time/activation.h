#pragma once

#include "nsfd/dynamics/dynamics.h"
#include "nsfd/mesh/discretization.h"
#include "nsfd/nonsmooth/one_step_problem.h"

#include <vector>

namespace nsfd
{
  /**
   * Let go of rigidly joined extrinsic points whose traction exceeds the
   * strength: they take part in @p problem with their law. True if there was
   * one. Collective.
   */
  template <int dim>
  bool activate(const Dynamics<dim> &dynamics,
                const std::vector<PointOrigin> &origins,
                const std::vector<double> &impulse,
                OneStepProblem<dim> &problem);
} // namespace nsfd
