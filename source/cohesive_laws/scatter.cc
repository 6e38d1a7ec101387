#include "nsfd/cohesive_laws/scatter.h"

#include <algorithm>
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

  double Scatter::factor(const double chance) const
  {
    switch (kind) {
    case Kind::none:
      return 1.;
    case Kind::uniform:
      return 1. + parameter * (2. * chance - 1.);
    case Kind::weibull: {
      // never 0: numbers are multiples of 2^-53, this is the middle of the
      // interval that rounds to them
      const double quantile = -std::log1p(-std::max(chance, 0x1p-54));
      return std::pow(quantile, 1. / parameter) /
             std::tgamma(1. + 1. / parameter);
    }
    }
    return 1.;
  }

  double scatter_number(const ScatterOf what, const unsigned int seed,
                        const std::array<double, 3> &x_scaled)
  {
    // seeds have 32 bits: those of the other quantity start above them
    std::uint64_t hash = mix(seed + (std::uint64_t(what) << 32));
    for (const double x : x_scaled)
      hash = mix(hash ^ box(x));
    return (hash >> 11) * 0x1p-53;
  }
} // namespace nsfd
