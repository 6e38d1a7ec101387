#pragma once

#include "extrinsic_law.h"

#include <algorithm>

namespace nsfd
{
  /**
   * Extrinsic, with the envelope T = R_max (1 - d / d_c), in Pa, of the opening
   * d in m: G = R_max d_c / 2. What d is, how it unloads, and its constants are
   * those of the law.
   */
  class LinearSoftening : public ExtrinsicLaw
  {
  public:
    double beta(const double d) const override
    {
      return d < critical_opening_ ? 1. - d / critical_opening_ : 0.;
    }

    double energy(const double d) const override
    {
      if (d >= critical_opening_)
        return toughness();
      return strength_ * d * (1. - 0.5 * d / critical_opening_);
    }

    double energy_increment(const double d0, const double d1) const override
    {
      // the way itself, and not what is left of it, keeps its digits
      const double a = std::min(d0, critical_opening_),
                   b = std::min(d1, critical_opening_);
      return strength_ * (b - a) *
             ((critical_opening_ - a) + (critical_opening_ - b)) /
             (2. * critical_opening_);
    }

    double toughness() const override
    {
      return 0.5 * strength_ * critical_opening_;
    }

    double steepest_softening() const override
    {
      return strength_ / critical_opening_;
    }
  };
} // namespace nsfd
