#include "engineering.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace nsfd
{
  namespace
  {
    struct Prefix {
      int exponent;
      const char *symbol;
    };

    const std::vector<Prefix> prefixes = {
        {-15, "f"}, {-12, "p"}, {-9, "n"}, {-6, "µ"}, {-3, "m"},
        {0, ""},    {3, "k"},   {6, "M"},  {9, "G"},  {12, "T"}};

    /** 2 for "m²" or "m^2", 3 for "m³", else 1. */
    int power_of(const std::string &unit)
    {
      const auto starts_with = [&](const char *text) {
        return unit.rfind(text, 0) == 0;
      };
      return starts_with("m²") || starts_with("m^2")   ? 2
             : starts_with("m³") || starts_with("m^3") ? 3
                                                       : 1;
    }
  } // namespace

  std::string power_of_ten(const int exponent)
  {
    static const std::array<const char *, 10> digits = {
        "⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string text = "10";
    for (const char c : std::to_string(exponent))
      text += c == '-' ? "⁻" : digits[c - '0'];
    return text;
  }

  std::string in_scientific(const double value, const unsigned int digits)
  {
    const std::string text =
        fmt::format("{:.{}e}", value, std::max(digits, 1u) - 1);
    const auto e = text.find('e');
    return text.substr(0, e) + "×" +
           power_of_ten(std::stoi(text.substr(e + 1)));
  }

  std::string with_minus(const std::string &text)
  {
    return !text.empty() && text[0] == '-' ? "−" + text.substr(1) : text;
  }

  DisplayUnit engineering_scale(const double largest, const std::string &unit)
  {
    const int power = power_of(unit);
    const double size = std::abs(largest);
    if (unit.empty() || size == 0. || !std::isfinite(size))
      return {1., unit};

    DisplayUnit scale{1., unit};
    for (const auto &prefix : prefixes) {
      const double factor = std::pow(10., power * prefix.exponent);
      if (unit == "s" && prefix.exponent > 0)
        break;
      // rounding must not give 1000 of the smaller unit
      if (size < 0.9995 * factor)
        break;
      scale = {factor, prefix.symbol + unit};
    }
    return scale;
  }

  std::string engineering(const double value, const std::string &unit,
                          const unsigned int digits)
  {
    if (!std::isfinite(value))
      return std::isnan(value) ? "n/a" : value > 0. ? "infinite" : "−infinite";
    const std::string suffix = unit.empty() ? "" : " " + unit;
    if (value == 0.)
      return "0" + suffix;

    const DisplayUnit scale = engineering_scale(value, unit);
    const double scaled = value / scale.factor;
    const double size = std::abs(scaled);
    const bool seconds = unit == "s";
    const double limit = power_of(unit) == 1 ? 1e4 : 1e10;
    if (size < (unit.empty() ? 1e-3 : 0.9) || (size >= limit && !seconds))
      return with_minus(in_scientific(value, digits)) + suffix;
    const int leading = static_cast<int>(std::floor(std::log10(size))) + 1;
    // 9.999 becomes 10.0, not 10.00
    const int carried = size >= std::pow(10., leading) *
                                    (1. - 0.5 * std::pow(10., -1. * digits))
                            ? leading + 1
                            : leading;
    const int decimals = std::max(0, static_cast<int>(digits) - carried);
    return with_minus(fmt::format("{:.{}f}", scaled, decimals)) +
           (scale.unit.empty() ? "" : " " + scale.unit);
  }

  DisplayUnit axis_scale(const double largest, const std::string &unit)
  {
    DisplayUnit scale = engineering_scale(largest, unit);
    const double value = std::abs(largest) / scale.factor;
    if (value > 0. && std::isfinite(value) && (value < 1e-2 || value >= 1e5)) {
      const int exponent = 3 * int(std::floor(std::log10(value) / 3.));
      scale.factor *= std::pow(10., exponent);
      scale.unit =
          power_of_ten(exponent) + (scale.unit.empty() ? "" : " " + scale.unit);
    }
    return scale;
  }
} // namespace nsfd
