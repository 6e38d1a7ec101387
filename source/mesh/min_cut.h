#pragma once

#include <array>
#include <vector>

namespace nsfd
{
  /** Cells of a mesh in a box, and the faces between them. */
  struct CellNetwork {
    struct Face {
      unsigned int first, second; ///< cells
      double area;
      bool may_break;
    };
    std::vector<std::array<double, 3>> centres;
    std::vector<Face> faces;
    std::vector<bool> is_at_boundary; ///< per cell
    std::array<double, 3> lower{}, upper{};
  };

  /** How much larger than a plane the smallest surface of faces is. */
  struct CutRatio {
    struct Direction {
      std::array<double, 3> normal;
      double ratio; ///< for boxes of many cells
    };
    std::vector<Direction> directions;
    double mean = 1.;        ///< for boxes of many cells
    double in_this_box = 1.; ///< the mean in the box as it is
  };

  /**
   * The smallest cut through the faces between the cells above and below a
   * plane through the middle of the box, over the area of the plane, for
   * normals all over a half sphere; cells at the boundary are held to their
   * side. In the box and in boxes of two thirds and one third of it about the
   * same middle, extrapolated to boxes of many cells by a straight line over
   * one over their size. The same in every run.
   */
  CutRatio cut_ratio(const CellNetwork &network,
                     unsigned int n_directions = 20);
} // namespace nsfd
