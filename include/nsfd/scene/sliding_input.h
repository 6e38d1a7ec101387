#pragma once

#include <limits>

namespace nsfd
{
  /** What sliding does to the surfaces in contact. */
  struct SlidingInput {
    double dilatancy = 0.; ///< tan(psi): u_N >= d(s), d(s) = s tan(psi)
    double saturation = std::numeric_limits<double>::infinity(); ///< of d, m
    double wear = 0.; ///< k of d(gap)/dt = k p_N |U_T|, 1/Pa

    bool lifts() const { return dilatancy > 0. || wear > 0.; }
  };
} // namespace nsfd
