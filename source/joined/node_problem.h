#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace nsfd
{
  /** The active points around one node, between groups of corners of cells. */
  template <int dim>
  struct NodeProblem {
    struct Point {
      std::size_t point; ///< in the OneStepProblem
      /// below, of body 1 and of body 2; -1: none (an obstacle or support at
      /// rest)
      std::array<int, 2> groups;
    };
    std::vector<Point> points;
    /// of every group and axis, 1/kg; 0 where the motion is prescribed
    std::vector<std::array<double, dim>> inverse_mass;
    /// of the groups, m/s: in without the impulses of the points, out with them
    std::vector<std::array<double, dim>> velocity;

    /** Empty; the memory stays. */
    void clear()
    {
      points.clear();
      inverse_mass.clear();
      velocity.clear();
    }
  };
} // namespace nsfd
