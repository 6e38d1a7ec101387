#pragma once

#include "nsfd/dynamics/dynamics.h"
#include "nsfd/mesh/discretization.h"
#include "nsfd/time/state.h"

namespace nsfd
{
  struct SceneInput;

  /**
   * State at t = 0: fields of the materials, gaps to obstacles, intact and
   * broken points, stored energies. @p problem is the constant data of the
   * points. Collective.
   */
  template <int dim>
  State initial_state(const SceneInput &input,
                      const Discretization<dim> &discretization,
                      const Dynamics<dim> &dynamics,
                      const OneStepProblem<dim> &problem);
} // namespace nsfd
