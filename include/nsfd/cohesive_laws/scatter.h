#pragma once

#include <array>
#include <cstdint>

namespace nsfd
{
  /**
   * A random factor with mean 1 around the strength or toughness of a law.
   * Uniform: in [1 - half_width, 1 + half_width). Weibull: the chance of a
   * factor below x is 1 - exp(-(x Gamma(1 + 1/m))^m), m the modulus.
   */
  struct Scatter {
    enum class Kind : std::uint8_t { none, uniform, weibull };
    Kind kind = Kind::none;
    double parameter = 0.; ///< half width in [0, 1), or modulus >= 1

    bool is_random() const { return kind != Kind::none; }

    /** The factor below which a share @p chance of all points lies. */
    double factor(double chance) const;
  };

  /** What is random at a point: each has numbers of its own. */
  enum class ScatterOf : std::uint8_t { strength, toughness };

  /**
   * Random number in [0, 1) of the point at @p x_scaled (its position divided
   * by a length of the scene, such as the diameter of the mesh), independent
   * from point to point.
   *
   * It is a hash of the seed and of the position rounded to boxes of 2^-24
   * (6e-8 of the length), so the same physical point has the same number on
   * every mesh, from both sides of a face and for any number of ranks. Points
   * are told apart if they are farther apart than a box. The boxes are shifted
   * by the golden ratio, which keeps their walls away from simple fractions: by
   * more than 100 machine epsilons for p/q with q up to 1000. At other
   * positions, round-off of 1e-15 changes the box with a chance of 2e-8 per
   * coordinate.
   */
  double scatter_number(ScatterOf what, unsigned int seed,
                        const std::array<double, 3> &x_scaled);
} // namespace nsfd
