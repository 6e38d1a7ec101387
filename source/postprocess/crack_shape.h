#pragma once

#include "nsfd/postprocess/broken_point.h"

#include <array>
#include <vector>

namespace nsfd
{
  /** Length, direction and straightness of a set of broken points. */
  struct CrackShape {
    double area = 0.; ///< of all points, m^2; m in two dimensions
    /// principal axes, from the longest to the shortest; in two dimensions the
    /// third is z
    std::array<std::array<double, 3>, 3> axes{};
    double extent = 0.; ///< along the first axis, m, with what is not broken
    /// in the plane: the part of the first axis below the pieces, m; in space:
    /// area seen along the last axis, m^2
    double projected = 0.;
    double tortuosity = 0.; ///< area/projected: 1 if straight, with or without
                            ///< gaps
  };

  /**
   * The principal axes are the eigenvectors of
   *
   *     S = sum w (x - x_m) (x - x_m)^T,   x_m = sum w x / sum w,
   *
   * which is the second moment of straight faces with two or more Gauss points
   * per direction. The extent reaches to the ends of the first and last piece
   * along the first axis. All is zero without points.
   */
  CrackShape crack_shape(const std::vector<BrokenPoint> &points,
                         unsigned int dimension);

  /** Of the first axis in the plane x, y: degrees, above -90, at most 90. */
  double crack_angle(const CrackShape &shape);

  /** The angle between two lines, degrees, 0 to 90. */
  double angle_between(double first, double second);
} // namespace nsfd
