#include "path_following.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  void PathFollowing::accept(const PathReport &report)
  {
    constexpr unsigned int few = 6, many = 12;
    constexpr double growth = 1.5;
    ++steps;
    // the load rises and nothing snaps: load steps again
    on = !report.at_longest;
    if (report.rounds == 0)
      return;
    points = std::max(1., report.points);
    if (report.rounds <= few)
      share = std::min(growth * share, largest_share);
    else if (report.rounds >= many)
      share /= growth;
  }

  bool PathFollowing::shorten()
  {
    share /= 4.;
    return share >= least_share;
  }

  void PathFollowing::serialize(Archive &archive)
  {
    archive.numbers("path_following", on, share, points, delay, steps);
  }
} // namespace nsfd
