#pragma once

#include "discretization.h"

#include "nsfd/scene/scene_input.h"

namespace nsfd
{
  /** Where no law ever parts cells, and where supports hold them. */
  template <int dim>
  FixedFaces fixed_faces(const Discretization<dim> &discretization)
  {
    const auto &faces = discretization.points().faces;
    FixedFaces result;
    result.joined.assign(faces.size(), 0);
    result.supports = result.joined;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      if (faces[f].count == 0)
        continue;
      const PointOrigin &origin = discretization.origins()[faces[f].first];
      result.supports[f] = origin.kind == PointOrigin::Kind::motion;
      if (origin.kind != PointOrigin::Kind::interface)
        continue;
      const auto &block = discretization.input().interfaces[origin.block];
      result.joined[f] = block.intact == IntactFaces::bonded && !block.law;
    }
    return result;
  }
} // namespace nsfd
