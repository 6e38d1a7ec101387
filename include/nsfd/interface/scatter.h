#pragma once

#include <array>

namespace nsfd
{
  /**
   * Strength factor of the point at @p x_scaled (its position divided by a
   * length of the scene, such as the diameter of the mesh): uniform in
   * [1 - half_width, 1 + half_width), independent from point to point.
   *
   * The factor is a hash of the seed and of the position rounded to boxes of
   * 2^-24 (6e-8 of the length), so the same physical point has the same factor
   * on every mesh, from both sides of a face and for any number of ranks.
   * Points are told apart if they are farther apart than a box. The boxes are
   * shifted by the golden ratio, which keeps their walls away from simple
   * fractions: by more than 100 machine epsilons for p/q with q up to 1000. At
   * other positions, round-off of 1e-15 changes the box with a chance of 2e-8
   * per coordinate.
   */
  double scatter_uniform(unsigned int seed,
                         const std::array<double, 3> &x_scaled,
                         double half_width);
} // namespace nsfd
