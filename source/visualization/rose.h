#pragma once

#include "svg.h"

#include <string>
#include <vector>

namespace nsfd
{
  /** A quantity by direction over half a turn; the other half is the same. */
  struct Rose {
    std::string title;
    std::string what;           ///< the values are: "shortest way / distance"
    std::vector<double> angles; ///< degrees
    std::vector<double> values, scatter;
    double mean = 0.;
  };

  /**
   * The excess of the values over 1 as the distance from the centre, with
   * circles at round numbers, the scatter as a band, and the mean.
   */
  std::string rose_picture(const Rose &rose, SvgUse use);
} // namespace nsfd
