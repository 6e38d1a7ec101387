#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/cohesive_laws/law_input.h"

#include <cmath>
#include <limits>

namespace nsfd
{
  /**
   * Elastic and perfectly brittle, intrinsic:
   *
   *   d^2 = <u_N>_+^2 + C_T / C_N |u_T|^2,
   *   beta = 1 up to d_0 = R_max / C, 0 beyond,   G = R_max^2 / (2 C).
   *
   * The law that (7)-(11) of [AM06] give for a stored energy linear in
   * beta, w = G. The traction jumps at d_0, the area I(d) under it does not:
   * the stored energy G turns into damage at once. Two of stiffness, strength
   * and toughness are free.
   */
  class Brittle final : public CohesiveLaw
  {
  public:
    explicit Brittle(SectionReader &reader)
    {
      const auto peak = laws::read_elastic_peak(reader, "brittle", 0.5,
                                                "G = R_max^2 / (2 C)");
      stiffness_ = peak.stiffness;
      elastic_limit_ = peak.opening;
      stiffness_ratio_ = laws::read_stiffness_ratio(reader, stiffness_);
    }

    bool extrinsic() const override { return false; }
    double normal_stiffness() const override { return stiffness_; }
    double stiffness_ratio() const override { return stiffness_ratio_; }
    double shear_weight() const override { return stiffness_ratio_; }

    double beta(const double d) const override
    {
      return d <= elastic_limit_ ? 1. : 0.;
    }

    double traction(const double d) const override
    {
      return d <= elastic_limit_ ? stiffness_ * d : 0.;
    }

    double energy(const double d) const override
    {
      return d <= elastic_limit_ ? 0.5 * stiffness_ * d * d : toughness();
    }

    double elastic_limit() const override { return elastic_limit_; }
    double peak_opening() const override { return elastic_limit_; }

    /** The first number beyond the jump. */
    double final_opening() const override
    {
      return std::nextafter(elastic_limit_,
                            std::numeric_limits<double>::infinity());
    }

    double strength() const override { return stiffness_ * elastic_limit_; }

    double toughness() const override
    {
      return 0.5 * stiffness_ * elastic_limit_ * elastic_limit_;
    }

    double steepest_softening() const override
    {
      return std::numeric_limits<double>::infinity();
    }

  private:
    double stiffness_, elastic_limit_, stiffness_ratio_;
  };

  NSFD_REGISTER(CohesiveLawRegistry, Brittle, "brittle",
                "Intrinsic, elastic up to R_max, then nothing; from two of "
                "stiffness, strength and toughness",
                "stiffness = 5e12; strength = 10 MPa",
                "strength = 300 MPa; toughness = 0.5 J/m^2; "
                "tangential stiffness = 3e16");
} // namespace nsfd
