#pragma once

#include <algorithm>
#include <limits>
#include <vector>

namespace nsfd
{
  /**
   * The time that the formulas of Boundary blocks are evaluated at: that of the
   * run until a block holds, that of its event afterwards.
   */
  struct LoadClock {
    /// s, by block; infinite: it has not stopped. Empty: no block ever stops
    std::vector<double> stopped;

    double at(const unsigned int block, const double t) const
    {
      return stopped.empty() ? t : std::min(t, stopped[block]);
    }
    /** A motion of the block has come to rest before @p t. */
    bool rests(const unsigned int block, const double t) const
    {
      return !stopped.empty() && t > stopped[block];
    }

    static constexpr double runs = std::numeric_limits<double>::infinity();
  };
} // namespace nsfd
