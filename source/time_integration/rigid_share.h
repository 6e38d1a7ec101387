#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace nsfd
{
  /** What the free unknowns of a rigid body have in the velocity of a place,
      from number @p first on. */
  template <int dim>
  struct RigidShare {
    std::size_t first;
    std::vector<std::array<double, dim>> columns;
  };
} // namespace nsfd
