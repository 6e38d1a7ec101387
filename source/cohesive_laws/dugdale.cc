#include "extrinsic_law.h"

#include "nsfd/cohesive_laws/law_input.h"

#include <algorithm>
#include <limits>

namespace nsfd
{
  /**
   * The gate of Dugdale and Barenblatt, extrinsic with constant traction:
   *
   *   d^2 = <u_N>_+^2 + a^2 |u_T|^2,
   *   T = R_max and beta = 1 below d_c, both 0 from d_c on,   G = R_max d_c.
   *
   * Unloading is on the secant to the origin, R = R_max / d_m (<u_N>_+ n +
   * a^2 u_T): opening to d_m and closing again dissipates R_max d_m / 2, though
   * beta is still 1. The traction jumps at d_c, the area under it does not.
   */
  class Dugdale final : public ExtrinsicLaw
  {
  public:
    explicit Dugdale(SectionReader &reader)
    {
      laws::Separation separation(reader);
      separation.complete(reader, "dugdale", 1., "G = R_max d_c");
      strength_ = *separation.strength;
      critical_opening_ = *separation.critical_opening;
      shear_weight_ = laws::read_shear_weight(reader);
    }

    double beta(const double d) const override
    {
      return d < critical_opening_ ? 1. : 0.;
    }

    double energy(const double d) const override
    {
      return strength_ * std::min(d, critical_opening_);
    }

    double energy_increment(const double d0, const double d1) const override
    {
      return strength_ * (std::min(d1, critical_opening_) -
                          std::min(d0, critical_opening_));
    }

    double toughness() const override { return strength_ * critical_opening_; }

    double steepest_softening() const override
    {
      return std::numeric_limits<double>::infinity();
    }
  };

  NSFD_REGISTER(CohesiveLawRegistry, Dugdale, "dugdale",
                "Extrinsic, constant traction up to d_c (gate); from two of "
                "strength, toughness and critical opening",
                "strength = 300 MPa; toughness = 0.5 J/m^2",
                "strength = 300 MPa; critical opening = 1 um; "
                "mode mixity = 0.7");
} // namespace nsfd
