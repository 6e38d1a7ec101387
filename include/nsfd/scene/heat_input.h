#pragma once

#include "nsfd/parameters/expression.h"

#include <optional>

namespace nsfd
{
  /** How the bodies of a material become warm. */
  struct HeatOfMaterial {
    double capacity = 0.;      ///< c, J/(kg K)
    double conductivity = 0.;  ///< k, W/(m K); 0: adiabatic
    Expression initial;        ///< temperature at t = 0, K, of x, y, z
    double plastic_share = 1.; ///< of the plastic work: what becomes heat
  };

  /** What flows through faces whose sides have parted. */
  struct HeatOfFaces {
    /// of closed ones, W/(m^2 K); nothing: they conduct as the bodies do
    std::optional<double> conductance;
    double gap_conductivity = 0.; ///< of what fills open ones, W/(m K)
  };
} // namespace nsfd
