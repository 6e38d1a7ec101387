#pragma once

namespace nsfd
{
  /** Over all places of a material, in the units of the scene. */
  struct MaterialExtremes {
    struct Moduli {
      double young = 0., poisson = 0.;
    };
    Moduli stiffest, softest;          ///< places or directions
    double fastest = 0., slowest = 0.; ///< speeds of plane waves
    double densest = 0.;
  };
} // namespace nsfd
