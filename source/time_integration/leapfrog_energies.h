#pragma once

namespace nsfd
{
  /** What the bodies have and take in a step of Leapfrog, J; `power` is f.v+ of
      the elastic forces, W, and f.v- before it. */
  struct LeapfrogEnergies {
    double kinetic = 0., stored = 0., work = 0., numerical = 0.;
    double power = 0., power_before = 0., power_after = 0.;
    double viscous = 0., plastic = 0., pressure_work = 0.;
    double absorbed = 0.; ///< by the sides
    double turned = 0.;   ///< more is stored in points, as their faces turn
    double large = 0.;    ///< a part of `numerical`: see WatchedLine
    double friction = 0., positive_friction = 0., impact = 0.; ///< of surfaces
    double penetration = 0., excess = 0.;                      ///< of them, m
    unsigned int touching = 0;
  };
} // namespace nsfd
