#pragma once

#include <array>
#include <vector>

namespace nsfd
{
  /**
   * The Delaunay tetrahedra of points in space, of positive volume: they fill
   * the convex hull.
   *
   * @throws std::runtime_error if points coincide
   */
  std::vector<std::array<unsigned int, 4>>
  delaunay_tetrahedra(const std::vector<std::array<double, 3>> &points);
} // namespace nsfd
