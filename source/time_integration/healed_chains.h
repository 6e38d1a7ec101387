#pragma once

#include "leapfrog_chains.h"

#include "nonsmooth/healing.h"

#include <array>

namespace nsfd
{
  /**
   * What a pressed point of explicit steps gains at the end of a step: both
   * chains at once, since each goes on from the jump of the other one, and the
   * slip that new bonds take away is one.
   */
  template <int dim>
  class HealedChains
  {
  public:
    /** Of point @p a after the step that is tried. */
    HealedChains(const LeapfrogChains<dim> &chains, unsigned int a,
                 const PointEnergies<dim> &energies);

    bool heals() const { return heals_; }
    /** J per area of a chain, not negative. */
    double dissipated() const { return heals_ ? dissipated_ : 0.; }

    /** Into the chains, whose jumps and histories are those of the end of the
        step. */
    void keep(LeapfrogChains<dim> &chains) const;

  private:
    unsigned int a_;
    bool heals_ = false;
    double dissipated_ = 0.;
    Healing of_step_, of_other_;
    std::array<double, dim> shift_{};
  };
} // namespace nsfd
