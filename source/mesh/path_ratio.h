#pragma once

#include <array>
#include <vector>

namespace nsfd
{
  /** Faces of a plane mesh along which a crack may run. */
  struct CrackNetwork {
    std::vector<std::array<double, 2>> points;
    std::vector<std::array<unsigned int, 2>> faces;
    double area = 0.; ///< of the mesh
  };

  /** How much longer than the straight one the shortest way along faces is. */
  struct PathRatio {
    struct Direction {
      double angle;         ///< to the x axis, degrees
      double mean, scatter; ///< of its pairs; standard deviation
      unsigned int n_pairs;
    };
    std::vector<Direction> directions; ///< that have a pair
    double mean = 1.;
    double error = 0.; ///< of the mean, by the scatter in each direction
    unsigned int n_pairs = 0;
    double distance = 0.; ///< of the two points of a pair, about
    /// of the points between which ways were looked for: the side of the
    /// square that one of them has
    double spacing = 0.;
  };

  /**
   * Between @p n_pairs pairs of points in each of @p n_directions directions
   * over half a turn, 43 spacings apart, or as far as the mesh is wide. The
   * points are those from which most ways lead: a centroid between three faces
   * of its own costs a way a detour that a longer one does not have. The same
   * in every run.
   */
  PathRatio path_ratio(const CrackNetwork &network,
                       unsigned int n_directions = 24,
                       unsigned int n_pairs = 10);
} // namespace nsfd
