#pragma once

#include "nsfd/parameters/expression.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace nsfd
{
  /** How the bodies of a material become warm. */
  struct HeatOfMaterial {
    double capacity = 0.;      ///< c, J/(kg K)
    double conductivity = 0.;  ///< k, W/(m K); 0: adiabatic
    Expression initial;        ///< temperature at t = 0, K, of x, y, z
    double plastic_share = 1.; ///< of the plastic work: what becomes heat
  };

  /** A factor that depends on temperature: linear between its points, constant
      beyond them, 1 without any. */
  struct TemperatureFactor {
    std::vector<double> temperature; ///< K, ascending
    std::vector<double> factor;

    bool is_given() const { return !temperature.empty(); }

    /** At @p T, in K. */
    double at(const double T) const
    {
      if (!is_given())
        return 1.;
      const auto above =
          std::upper_bound(temperature.begin(), temperature.end(), T);
      const auto k = std::size_t(above - temperature.begin());
      if (k == 0)
        return factor.front();
      if (k == temperature.size())
        return factor.back();
      const double share =
          (T - temperature[k - 1]) / (temperature[k] - temperature[k - 1]);
      return factor[k - 1] + share * (factor[k] - factor[k - 1]);
    }

    double least() const
    {
      return is_given() ? *std::min_element(factor.begin(), factor.end()) : 1.;
    }
  };

  /** What flows through faces whose sides have parted, and what temperature
      does to them. */
  struct HeatOfFaces {
    /// of closed ones, W/(m^2 K); nothing: they conduct as the bodies do
    std::optional<double> conductance;
    double gap_conductivity = 0.;          ///< of what fills open ones, W/(m K)
    TemperatureFactor strength, toughness; ///< of extrinsic laws
    TemperatureFactor friction;

    bool changes_law() const
    {
      return strength.is_given() || toughness.is_given();
    }
  };
} // namespace nsfd
