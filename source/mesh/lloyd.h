#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace nsfd
{
  /**
   * One step of Lloyd with a density: every node from @p first on moves to the
   * centroid of what is nearer to it than to any other node, within the
   * Delaunay simplices @p corners around it. With the density size^-(dim + 2)
   * nodes come to be about as far apart as @p size, their values there, says.
   */
  template <int dim>
  void move_to_centroids(
      std::vector<std::array<double, dim>> &nodes, std::size_t first,
      const std::vector<std::array<unsigned int, dim + 1>> &corners,
      const std::vector<double> &size);
} // namespace nsfd
