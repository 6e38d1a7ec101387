#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/cohesive_laws/law_input.h"

#include <cmath>
#include <string>

namespace nsfd
{
  namespace
  {
    /** G / (C d_c^2) = 9/2 - 4 ln 2. */
    const double energy_factor = 4.5 - 4. * std::log(2.);
  } // namespace

  /**
   * The law of Michel and Suquet, equation (19) of [AM06], intrinsic and
   * elastic up to d_c:
   *
   *   beta = 1,  (3 d_c - d) / (d_c + d),  0      on [0, d_c), [d_c, 3 d_c),
   * ...
   *
   * hence R_max = C d_c and G = (9/2 - 4 ln 2) R_max^2 / C, and only two of
   * stiffness, strength and toughness are free. The opening is weighted with
   * C_T / C_N in shear (the norm of the stored energy), so that the law has a
   * potential for any tangential stiffness.
   */
  class MichelSuquet final : public CohesiveLaw
  {
  public:
    explicit MichelSuquet(SectionReader &reader)
    {
      const auto peak =
          laws::read_elastic_peak(reader, "michel-suquet", energy_factor,
                                  "G = (9/2 - 4 ln 2) R_max^2 / C");
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
      if (d <= elastic_limit_)
        return 1.;
      if (d >= final_opening())
        return 0.;
      return (final_opening() - d) / (elastic_limit_ + d);
    }

    double traction(const double d) const override
    {
      return beta(d) * stiffness_ * d;
    }

    double energy(const double d) const override
    {
      if (d <= elastic_limit_)
        return 0.5 * stiffness_ * d * d;
      if (d >= final_opening())
        return toughness();
      // y = x - 1 = d / d_c - 1
      const double y = (d - elastic_limit_) / elastic_limit_;
      return stiffness_ * elastic_limit_ * elastic_limit_ *
             (0.5 + y * (3. - 0.5 * y) - 4. * std::log1p(0.5 * y));
    }

    double elastic_limit() const override { return elastic_limit_; }
    double peak_opening() const override { return elastic_limit_; }
    double final_opening() const override { return 3. * elastic_limit_; }
    double strength() const override { return stiffness_ * elastic_limit_; }

    double toughness() const override
    {
      return energy_factor * stiffness_ * elastic_limit_ * elastic_limit_;
    }

    /** At the very end, where the traction is 0. */
    double steepest_softening() const override { return 0.75 * stiffness_; }

  private:
    double stiffness_, elastic_limit_, stiffness_ratio_;
  };

  NSFD_REGISTER(CohesiveLawRegistry, MichelSuquet, "michel-suquet",
                "Intrinsic, elastic up to d_c, (19); from two of stiffness, "
                "strength and toughness",
                "strength = 324 MPa; toughness = 0.5 J/m^2",
                "stiffness = 1e18; toughness = 10 J/m^2; "
                "tangential stiffness = 3e17");
} // namespace nsfd
