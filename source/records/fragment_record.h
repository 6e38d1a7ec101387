#pragma once

#include "nsfd/core/space.h"

namespace nsfd
{
  /**
   * One fragment as a whole, in its present place. In the plane masses,
   * energies and areas are per metre of depth, and only spin[2] and
   * inertia[2][2] are not zero. Of an axisymmetric piece they are per radian,
   * and x is a mean over its section.
   */
  struct FragmentRecord {
    unsigned int number = 0;
    unsigned long long cells = 0;
    bool axisymmetric =
        false;          ///< measures are per radian, and their centres means
    double mass = 0.;   ///< kg, kg/m
    double volume = 0.; ///< of its cells at rest, m^3, m^2
    Vec3 centre{};      ///< of mass, m
    Vec3 velocity{};    ///< momentum over mass, m/s
    Vec3 spin{};        ///< J^{-1} L about the centre, rad/s
    Mat3 inertia{};     ///< J about the centre, axes of space, kg m^2, kg m
    /// of the centre, of the spin, and of all cells (the rest is vibration), J
    double kinetic_translation = 0., kinetic_spin = 0., kinetic = 0.;
    double surface = 0.; ///< of its cells, broken since t = 0, m^2, m

    /** Diameter of the disc or ball of the same volume, m; of a ring that of
        the ball. */
    double size(unsigned int dimension) const;
  };
} // namespace nsfd
