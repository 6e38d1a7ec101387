#pragma once

#include <vector>

namespace nsfd
{
  class Communicator;

  /** What the bodies store, lose and take from loads in a step, in J. */
  struct BodyEnergies {
    double kinetic = 0., elastic = 0.;   ///< after the step
    double of_mass = 0., of_strain = 0.; ///< what theta > 1/2 takes
    double work = 0.;                    ///< of the loads
    double plastic = 0., viscous = 0.;   ///< what the bodies dissipate
    double absorbed = 0.;                ///< by their sides
  };

  /** Of the bodies of all ranks, whatever their order. Collective. */
  BodyEnergies sum(const Communicator &all,
                   const std::vector<BodyEnergies> &bodies);
} // namespace nsfd
