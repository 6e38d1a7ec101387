#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace nsfd::test
{
  /**
   * The lowest radial mode of a full cylinder of radius 1 whose length is held:
   * u_r = J_1(k r), (lambda + 2 mu) k J_0(k) = 2 mu J_1(k).
   */
  struct BreathingMode {
    BreathingMode(const double lambda, const double mu)
    {
      const auto residual = [&](const double x) {
        return (lambda + 2. * mu) * x * std::cyl_bessel_j(0., x) -
               2. * mu * std::cyl_bessel_j(1., x);
      };
      double low = 1., high = 3.;
      while (high - low > 1e-14 * high)
        ((residual(low) < 0.) == (residual((low + high) / 2.) < 0.) ? low
                                                                    : high) =
            (low + high) / 2.;
      k = low;
      double factor = k / 2.;
      for (int m = 0; m < 13; ++m, factor *= -k * k / 4. / (m * (m + 1.)))
        formula += fmt::format(" + {:.17g} * x^{}", factor, 2 * m + 1);
    }
    double k = 0.;
    std::string formula = "0"; ///< J_1(k x), to 1e-16
  };
} // namespace nsfd::test
