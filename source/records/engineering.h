#pragma once

#include <string>

namespace nsfd
{
  /** Values are divided by `factor` and then read in `unit` ("µJ/m"). */
  struct DisplayUnit {
    double factor = 1.;
    std::string unit;
  };

  /**
   * The engineering prefix that brings @p largest between 1 and 1000. Units
   * that start with a power ("m²", "m^3") get the power of the prefix, times
   * ("s") no prefix above 1, "" none at all.
   */
  DisplayUnit engineering_scale(double largest, const std::string &unit);

  /** Also where there is no prefix: "10⁻²¹ J/m", "10⁻⁶". */
  DisplayUnit axis_scale(double largest, const std::string &unit);

  /** "5.00 µJ/m": @p digits significant digits; "n/a" for NaN. */
  std::string engineering(double value, const std::string &unit,
                          unsigned int digits = 3);

  /** 10⁻¹⁸ */
  std::string power_of_ten(int exponent);

  /** 1.2×10⁻⁷ */
  std::string in_scientific(double value, unsigned int digits);

  /** A minus sign as long as a plus. */
  std::string with_minus(const std::string &text);
} // namespace nsfd
