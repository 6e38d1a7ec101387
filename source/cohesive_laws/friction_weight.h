#pragma once

#include <algorithm>
#include <cmath>

namespace nsfd
{
  /**
   * Share of the friction coefficient that acts at damage @p beta, equation
   * (18) of [AM06]: kappa = (1 - beta)^s, from 0 (intact) to 1 (broken).
   * The exponent s = 0 stands for kappa = 1.
   */
  inline double kappa(const double beta, const double exponent)
  {
    if (exponent == 0.)
      return 1.;
    const double broken = std::max(0., 1. - beta);
    return exponent == 1. ? broken : std::pow(broken, exponent);
  }
} // namespace nsfd
