#pragma once

#include <cstdint>

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
} // namespace nsfd
