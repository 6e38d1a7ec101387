#pragma once

#include "nsfd/parameters/expression.h"

#include <array>

namespace nsfd
{
  /** How far apart nodes shall be: a formula of the place, and a factor. */
  struct SizeField {
    Expression formula{1.};
    double factor = 1.;

    /** @throws std::runtime_error if it is no length there */
    double at(double x, double y, double z) const;

    double operator()(const std::array<double, 2> &p) const
    {
      return at(p[0], p[1], 0.);
    }
    double operator()(const std::array<double, 3> &p) const
    {
      return at(p[0], p[1], p[2]);
    }
  };
} // namespace nsfd
