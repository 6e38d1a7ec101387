#pragma once

#include "equilibrium_search.h"

namespace nsfd
{
  class Archive;

  /**
   * How far steps along a path of equilibria go: control of the dissipation,
   * Gutierrez (2004), Verhoosel, Remmers and Gutierrez (2009). A step
   * dissipates a share of the toughness of the points that shared the last one.
   */
  struct PathFollowing {
    static constexpr double first_share = 0.1, largest_share = 0.25,
                            least_share = 1e-5;

    bool on = false; ///< or load steps, as long as an equilibrium continues
    double share = first_share, points = 1.;
    double delay = 0.;      ///< of the load time behind that of the run, s
    unsigned int steps = 0; ///< that were taken on the path

    /** The step that @p report tells of is taken. */
    void accept(const PathReport &report);
    /** For one that was not: false if none is left to be tried. */
    bool shorten();
    void serialize(Archive &archive);
  };
} // namespace nsfd
