#pragma once

#include "nsfd/bodies/rigid_step.h"

#include <vector>

namespace nsfd
{
  /** The motion of the bodies of this rank in a step, see MovingBodies. */
  struct StepMotion {
    double time_step = 0., theta = 0.5;
    std::vector<double> u_old, u_new, forces; ///< by node
    std::vector<double> history;  ///< of the materials, at the start
    std::vector<double> v_old, v; ///< by unknown
    std::vector<RigidStep> rigid;
    std::vector<double> shift_middle; ///< of the obstacles, 3 each, or none
  };
} // namespace nsfd
