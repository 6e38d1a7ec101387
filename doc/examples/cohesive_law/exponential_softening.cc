#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/parameters/section_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  /**
   * Extrinsic, falls exponentially and never breaks altogether, as
   * quasi-brittle materials are often described:
   *
   *   d^2 = <u_N>_+^2 + |u_T|^2,   T = R_max exp(-d / l),   l = G / R_max.
   *
   * Unloading is on the secant to the origin.
   */
  class ExponentialSoftening final : public CohesiveLaw
  {
  public:
    explicit ExponentialSoftening(SectionReader &reader)
        : strength_(reader.number("strength", "", units::pressure,
                                  Range::positive(), "Largest traction R_max")),
          toughness_(reader.number("toughness", "", units::energy_per_area,
                                   Range::positive(), "Fracture energy G"))
    {
    }

    bool extrinsic() const override { return true; }
    double normal_stiffness() const override { return infinity; }
    double stiffness_ratio() const override { return 1.; }
    double shear_weight() const override { return 1.; }

    double beta(const double d) const override
    {
      return std::exp(-d / length());
    }
    double traction(const double d) const override
    {
      return strength_ * beta(d);
    }
    double energy(const double d) const override
    {
      return toughness_ * -std::expm1(-d / length());
    }
    double energy_increment(const double d0, const double d1) const override
    {
      // seen from the smaller one: of a far one nothing is left
      const double change = toughness_ * beta(std::min(d0, d1)) *
                            -std::expm1(-std::abs(d1 - d0) / length());
      return d1 < d0 ? -change : change;
    }

    double elastic_limit() const override { return 0.; }
    double peak_opening() const override { return 0.; }
    double final_opening() const override { return infinity; }
    double strength() const override { return strength_; }
    double toughness() const override { return toughness_; }
    double steepest_softening() const override { return strength_ / length(); }

  private:
    static constexpr double infinity = std::numeric_limits<double>::infinity();
    double length() const { return toughness_ / strength_; }

    double strength_, toughness_;
  };

  NSFD_REGISTER(CohesiveLawRegistry, ExponentialSoftening,
                "exponential softening",
                "Extrinsic, T = R_max exp(-d R_max / G)",
                "strength = 300 MPa; toughness = 0.5 J/m^2");
} // namespace nsfd
