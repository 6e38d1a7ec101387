#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace nsfd
{
  /** splitmix64 */
  inline std::uint64_t mixed(std::uint64_t z)
  {
    z += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  /** Random in [0, 1), the same on every machine. */
  inline double uniform(const std::uint64_t seed, const std::uint64_t number)
  {
    return std::ldexp(double(mixed(mixed(seed) + number) >> 11), -53);
  }

  /** @p sum mixed with @p size bytes, eight by eight: a checksum. */
  inline std::uint64_t mixed(std::uint64_t sum, const char *bytes,
                             const std::size_t size)
  {
    for (std::size_t i = 0; i < size; i += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes + i, std::min<std::size_t>(8, size - i));
      sum = mixed(sum ^ word);
    }
    return sum;
  }
} // namespace nsfd
