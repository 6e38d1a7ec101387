#pragma once

#include "records/engineering.h"

#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <string>

namespace nsfd
{
  inline void table_line(const char *name, const std::string &value)
  {
    std::cout << fmt::format("  {:<20} {}\n", name, value);
  }

  /** "3.375 J/m²  (1 G)" */
  inline std::string share_of(const double energy, const double toughness)
  {
    if (std::abs(energy) < 1e-12 * toughness)
      return "0";
    return fmt::format("{}  ({:.4g} G)", engineering(energy, "J/m²", 4),
                       energy / toughness);
  }
} // namespace nsfd
