#pragma once

#include <string>

namespace nsfd
{
  /** What energies, forces and masses are per, after their unit: nothing in
      space, in two dimensions the metre of depth or the radian. */
  inline std::string per_extent(const unsigned int dimension,
                                const bool axisymmetric)
  {
    return dimension == 3 ? "" : axisymmetric ? "/rad" : "/m";
  }

  /** The same of areas, @p square in space: lengths in the plane. */
  inline std::string area_unit(const std::string &square,
                               const unsigned int dimension,
                               const bool axisymmetric)
  {
    return dimension == 2 && !axisymmetric
               ? "m"
               : square + per_extent(dimension, axisymmetric);
  }
} // namespace nsfd
