#include "energy_lines.h"

namespace nsfd
{
  using Colour = LineChart::Colour;

  const std::vector<EnergyLine> &stored_lines()
  {
    static const std::vector<EnergyLine> lines = {
        {"kinetic", &EnergyLines::kinetic, Colour::blue},
        {"elastic", &EnergyLines::elastic, Colour::sky},
        {"cohesive", &EnergyLines::cohesive, Colour::violet}};
    return lines;
  }

  const std::vector<EnergyLine> &dissipated_lines()
  {
    static const std::vector<EnergyLine> lines = {
        {"damage", &EnergyLines::damage, Colour::red},
        {"friction", &EnergyLines::friction, Colour::orange},
        {"viscous", &EnergyLines::viscous, Colour::olive},
        {"plastic", &EnergyLines::plastic, Colour::green},
        {"impact", &EnergyLines::impact, Colour::pink},
        {"numerical", &EnergyLines::numerical, Colour::grey},
        {"absorbed", &EnergyLines::absorbed, Colour::ink}};
    return lines;
  }

  std::vector<EnergyLine> all_lines()
  {
    auto lines = stored_lines();
    lines.insert(lines.end(), dissipated_lines().begin(),
                 dissipated_lines().end());
    return lines;
  }

  double sum_of(const EnergyLines &energy, const std::vector<EnergyLine> &lines)
  {
    double sum = 0.;
    for (const auto &line : lines)
      sum += energy.*line.member;
    return sum;
  }
} // namespace nsfd
