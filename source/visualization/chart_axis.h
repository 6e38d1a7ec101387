#pragma once

#include "records/engineering.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace nsfd
{
  /** The smallest of 1, 2, 5, 10 ... that is not below @p x. */
  double nice_above(double x);

  /** The largest one that is not above. */
  double nice_below(double x);

  /** Digits behind the point of the multiples of @p step. */
  int decimals_of(double step);

  /** Data interval, pixels and ticks of one direction of a chart. */
  class AxisMap
  {
  public:
    struct Tick {
      double value;
      std::string label; ///< may be empty
    };

    double lower = 0., upper = 1.; ///< log10 of the values if logarithmic
    double pixel_lower = 0., pixel_upper = 1.;
    bool logarithmic = false;
    DisplayUnit scale;
    std::vector<Tick> ticks;

    bool shows(const double value) const
    {
      return std::isfinite(value) && (!logarithmic || value > 0.);
    }

    double operator()(const double value) const
    {
      const double x = logarithmic ? std::max(std::log10(value), lower) : value;
      return pixel_lower +
             (x - lower) / (upper - lower) * (pixel_upper - pixel_lower);
    }

    /** Interval and ticks of a linear axis. */
    void set_linear(double smallest, double largest, const std::string &unit,
                    bool integers, bool to_full_ticks);

    /** Interval and ticks of a logarithmic axis. */
    void set_logarithmic(double smallest, double largest,
                         const std::string &unit);
  };
} // namespace nsfd
