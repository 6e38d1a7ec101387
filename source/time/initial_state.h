#pragma once

#include "nsfd/dynamics/bonded.h"
#include "nsfd/mesh/discretization.h"
#include "nsfd/time/state.h"

namespace nsfd
{
  struct SceneInput;

  /**
   * State at t = 0: fields of the materials, gaps to obstacles, intact and
   * broken points, stored energies. @p problem is the constant data of the
   * points. Jumps of bonded faces are in the elastic energy: their bonds are set
   * in @p bonded (null: there are none). Collective.
   */
  template <int dim>
  State initial_state(const SceneInput &input,
                      const Discretization<dim> &discretization,
                      const Dynamics<dim> &dynamics,
                      const OneStepProblem<dim> &problem,
                      BondedDynamics<dim> *bonded);
} // namespace nsfd
