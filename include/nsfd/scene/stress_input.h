#pragma once

#include "nsfd/parameters/expression.h"

#include <algorithm>
#include <array>
#include <optional>

namespace nsfd
{
  /** A stress at t = 0 by its components xx, yy, zz, xy, xz, yz: Pa, of x, y,
      z; tension is positive. */
  struct StressInput {
    std::array<std::optional<Expression>, 6> parts;

    bool is_given() const
    {
      return std::any_of(parts.begin(), parts.end(),
                         [](const auto &part) { return part.has_value(); });
    }
  };
} // namespace nsfd
