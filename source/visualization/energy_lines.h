#pragma once

#include "svg.h"

#include "nsfd/core/per_extent.h"

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
        : Units(per_extent(dimension, axisymmetric),
                nsfd::area_unit("m²", dimension, axisymmetric))
    {
    }
    std::string energy, force, area, mass, broken;

  private:
    Units(const std::string &per, const std::string &of_areas)
        : energy("J" + per), force("N" + per), area(of_areas), mass("g" + per),
          broken(area == "m" ? "broken length" : "broken area")
    {
    }
  };
} // namespace nsfd
