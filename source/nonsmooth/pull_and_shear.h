#pragma once

#include <algorithm>
#include <cmath>

namespace nsfd
{
  /**
   * Size of a traction (or impulse) as a strength is compared with it:
   * sqrt(<pull>_+^2 + |shear|^2 / r^2), with r^2 = @p shear_weight the share of
   * the strength in shear, squared; 0: shear does not count. @p normal is
   * positive in tension, @p shear has dim - 1 entries.
   */
  template <int dim>
  double pull_and_shear(const double normal, const double *shear,
                        const double shear_weight)
  {
    const double pull = std::max(0., normal);
    double square = pull * pull;
    if (shear_weight > 0.)
      for (unsigned int c = 0; c + 1 < dim; ++c)
        square += shear[c] * shear[c] / shear_weight;
    return std::sqrt(square);
  }
} // namespace nsfd
