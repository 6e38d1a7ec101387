#include "chart_axis.h"

#include <fmt/format.h>

namespace nsfd
{
  double nice_above(const double x)
  {
    const double decade = std::pow(10., std::floor(std::log10(x)));
    for (const double digit : {1., 2., 5.})
      if (x <= digit * decade * (1. + 1e-9))
        return digit * decade;
    return 10. * decade;
  }

  double nice_below(const double x)
  {
    const double decade = std::pow(10., std::floor(std::log10(x) + 1e-12));
    for (const double digit : {5., 2.})
      if (x >= digit * decade * (1. - 1e-9))
        return digit * decade;
    return decade;
  }

  int decimals_of(const double step)
  {
    return std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  }

  void AxisMap::set_linear(double smallest, double largest,
                           const std::string &unit, const bool integers,
                           const bool to_full_ticks)
  {
    if (to_full_ticks && smallest > 0. && smallest < 0.8 * largest)
      smallest = 0.;
    if (to_full_ticks && largest < 0. && largest > 0.8 * smallest)
      largest = 0.;
    const double size = std::max(std::abs(smallest), std::abs(largest));
    // one value: show it against zero
    if (largest - smallest <= 1e-9 * size || size == 0.) {
      smallest = std::min(smallest, 0.);
      largest = size == 0. ? 1. : std::max(largest, 0.);
    }
    scale = axis_scale(size, unit);

    double step = nice_above((largest - smallest) / scale.factor / 5.5);
    if (integers && scale.factor == 1.)
      step = std::max(step, 1.);
    double first = std::floor(smallest / scale.factor / step + 1e-6);
    double last = std::ceil(largest / scale.factor / step - 1e-6);
    if (to_full_ticks) {
      smallest = first * step * scale.factor;
      largest = last * step * scale.factor;
    } else {
      first = std::ceil(smallest / scale.factor / step - 1e-6);
      last = std::floor(largest / scale.factor / step + 1e-6);
    }
    lower = smallest;
    upper = largest;
    const int decimals = decimals_of(step);
    for (double i = first; i <= last; ++i)
      ticks.push_back({i * step * scale.factor,
                       with_minus(fmt::format(
                           "{:.{}f}", i == 0. ? 0. : i * step, decimals))});
  }

  void AxisMap::set_logarithmic(const double smallest, const double largest,
                                const std::string &unit)
  {
    // at most 20 decades: what lies below is drawn at the lower end
    const double top = std::ceil(std::log10(largest) - 1e-9);
    double bottom = std::floor(std::log10(smallest) + 1e-9);
    bottom = std::clamp(bottom, top - 20., top - 1.);
    lower = bottom;
    upper = top;
    scale.unit = unit;
    const int n_decades = static_cast<int>(top - bottom);
    const int stride = (n_decades + 6) / 7;
    for (int i = 0; i <= n_decades; ++i) {
      const int exponent = static_cast<int>(bottom) + i;
      const bool labelled = i % stride == 0;
      const bool plain = n_decades <= 4 && exponent >= 0 && exponent <= 4;
      ticks.push_back({std::pow(10., exponent),
                       !labelled ? ""
                       : plain ? fmt::format("{:.0f}", std::pow(10., exponent))
                               : power_of_ten(exponent)});
      if (n_decades > 2 || i == n_decades)
        continue;
      for (const int digit : {2, 5})
        ticks.push_back(
            {digit * std::pow(10., exponent),
             plain ? fmt::format("{:.0f}", digit * std::pow(10., exponent))
                   : fmt::format("{}×{}", digit, power_of_ten(exponent))});
    }
  }
} // namespace nsfd
