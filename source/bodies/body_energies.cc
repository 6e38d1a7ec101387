#include "body_energies.h"

#include "core/communicator.h"

#include <array>

namespace nsfd
{
  BodyEnergies sum(const Communicator &all,
                   const std::vector<BodyEnergies> &bodies)
  {
    constexpr std::array<double BodyEnergies::*, 8> lines = {
        {&BodyEnergies::kinetic, &BodyEnergies::elastic, &BodyEnergies::of_mass,
         &BodyEnergies::of_strain, &BodyEnergies::work, &BodyEnergies::plastic,
         &BodyEnergies::viscous, &BodyEnergies::absorbed}};
    std::vector<double> terms;
    for (const auto line : lines)
      for (const BodyEnergies &body : bodies)
        terms.push_back(body.*line);
    const auto sums = all.sums(terms.data(), lines.size(), bodies.size());
    BodyEnergies result;
    for (std::size_t k = 0; k < lines.size(); ++k)
      result.*lines[k] = sums[k];
    return result;
  }
} // namespace nsfd
