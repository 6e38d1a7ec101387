#pragma once

#include "nsfd/discretization/point_origin.h"
#include "nsfd/scene/scene_input.h"

namespace nsfd
{
  /** Of points that may touch obstacle @p b: with cohesion they are those of an
      interface. */
  inline PointOrigin origin_at_obstacle(const SceneInput &input,
                                        const unsigned int b)
  {
    const int cohesion = input.obstacles[b].cohesion;
    if (cohesion < 0)
      return {PointOrigin::Kind::obstacle, b};
    return {PointOrigin::Kind::interface, unsigned(cohesion)};
  }

  /** Which obstacle a point may touch, with cohesion or without; -1: none. */
  inline int obstacle_of(const SceneInput &input, const PointOrigin &origin)
  {
    switch (origin.kind) {
    case PointOrigin::Kind::interface:
      return input.interfaces[origin.block].obstacle;
    case PointOrigin::Kind::obstacle:
      return int(origin.block);
    default:
      return -1;
    }
  }
} // namespace nsfd
