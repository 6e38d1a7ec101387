#pragma once

#include "nsfd/cohesive_laws/cohesive_law.h"

#include <limits>

namespace nsfd
{
  /**
   * Rigid until the strength is reached, with a traction R_max beta(d), in Pa,
   * that ends at the critical opening, in m. beta, its area, how it unloads and
   * its constants are those of the law.
   */
  class ExtrinsicLaw : public CohesiveLaw
  {
  public:
    bool extrinsic() const override { return true; }

    double normal_stiffness() const override
    {
      return std::numeric_limits<double>::infinity();
    }

    double stiffness_ratio() const override { return shear_weight_; }
    double shear_weight() const override { return shear_weight_; }

    double traction(const double d) const override
    {
      return strength_ * beta(d);
    }

    double elastic_limit() const override { return 0.; }
    double peak_opening() const override { return 0.; }
    double final_opening() const override { return critical_opening_; }
    double strength() const override { return strength_; }

  protected:
    double strength_ = 0., critical_opening_ = 0., shear_weight_ = 0.;
  };
} // namespace nsfd
