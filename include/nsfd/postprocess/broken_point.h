#pragma once

#include <array>

namespace nsfd
{
  /** A broken interface point, on the undeformed body. */
  struct BrokenPoint {
    std::array<double, 3> position{}, normal{}; ///< m; unit vector
    double area = 0.; ///< its weight, m^2; m in two dimensions
    /// of the piece of the face that it stands for, m; in space the point
    std::array<std::array<double, 3>, 2> ends{};
  };
} // namespace nsfd
