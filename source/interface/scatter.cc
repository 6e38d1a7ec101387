#include "nsfd/interface/scatter.h"

#include <cmath>
#include <cstdint>
#include <cstring>

namespace nsfd
{
  namespace
  {
    /** Finaliser of splitmix64 (Steele, Lea and Flood 2014): a bijection. */
    std::uint64_t mix(std::uint64_t z)
    {
      z += 0x9e3779b97f4a7c15u;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
      return z ^ (z >> 31);
    }

    /** Index of the box along one axis: an integer, kept as a double's bits. */
    std::uint64_t box(const double x)
    {
      constexpr double boxes_per_length = 16777216.; // 2^24
      constexpr double golden_ratio = 0.61803398874989484820;

      const double index =
          std::floor(x * boxes_per_length + golden_ratio) + 0.; // no -0
      std::uint64_t bits;
      std::memcpy(&bits, &index, sizeof bits);
      return bits;
    }
  } // namespace

  double scatter_uniform(const unsigned int seed,
                         const std::array<double, 3> &x_scaled,
                         const double half_width)
  {
    std::uint64_t hash = mix(seed);
    for (const double x : x_scaled)
      hash = mix(hash ^ box(x));

    const double r = (hash >> 11) * 0x1p-53; // [0, 1)
    return 1. + half_width * (2. * r - 1.);
  }
} // namespace nsfd
