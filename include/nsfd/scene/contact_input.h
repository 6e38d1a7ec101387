#pragma once

#include "nsfd/scene/sliding_input.h"

#include <array>
#include <string>

namespace nsfd
{
  /** Contact between any two surfaces, of scenes with large motions. */
  struct ContactInput {
    std::string name;
    /// of the two bodies, in any order; empty: any. The first block that
    /// holds for two materials is theirs; without one they do not touch
    std::array<std::string, 2> materials;
    double friction = 0., restitution = 0.;
    SlidingInput sliding;    ///< wear only
    bool is_default = false; ///< the scene has no block
  };

  /** A place of a rigid body that stays where it is, in large motions. */
  struct PinInput {
    std::string name;
    std::string material;       ///< of the body; it has one body
    std::array<double, 3> at{}; ///< at t = 0, in the body or outside, m
  };
} // namespace nsfd
