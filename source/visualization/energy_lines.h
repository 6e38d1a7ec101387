#pragma once

#include "svg.h"

#include <string>
#include <vector>

namespace nsfd
{
  /** An energy line: its name, where it is, and its colour in charts. */
  struct EnergyLine {
    const char *name;
    double EnergyLines::*member;
    LineChart::Colour colour;
  };

  const std::vector<EnergyLine> &stored_lines();
  const std::vector<EnergyLine> &dissipated_lines();
  std::vector<EnergyLine> all_lines();

  double sum_of(const EnergyLines &energy,
                const std::vector<EnergyLine> &lines);

  /** Units of a run: in two dimensions everything is per metre of depth, in an
      axisymmetric one per radian. */
  struct Units {
    explicit Units(const unsigned int dimension,
                   const bool axisymmetric = false)
        : energy(dimension == 3 ? "J" : "J/m"),
          force(dimension == 3 ? "N" : "N/m"),
          area(dimension == 3 ? "m²" : "m"), mass(dimension == 3 ? "g" : "g/m"),
          broken(dimension == 3 ? "broken area" : "broken length")
    {
      if (!axisymmetric)
        return;
      energy = "J/rad";
      force = "N/rad";
      area = "m²/rad";
      mass = "g/rad";
      broken = "broken area";
    }
    std::string energy, force, area, mass, broken;
  };
} // namespace nsfd
