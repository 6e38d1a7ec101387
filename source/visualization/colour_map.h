#pragma once

#include <array>
#include <string>

namespace nsfd
{
  /** Red, green and blue from 0 to 255. */
  using Rgb = std::array<double, 3>;

  Rgb rgb(unsigned int code);         ///< 0xrrggbb
  std::string hex(const Rgb &colour); ///< #rrggbb
  Rgb mix(const Rgb &a, const Rgb &b, double t);

  /** Perceptually uniform from dark violet to yellow, x in [0, 1]. */
  Rgb colour_map(double x);
} // namespace nsfd
