#include "extrinsic_law.h"

#include "nsfd/cohesive_laws/law_input.h"

#include <cmath>
#include <limits>

namespace nsfd
{
  /**
   * The extrinsic limit of the law of Park, Paulino and Roesler, with one
   * opening for both directions:
   *
   *   d^2 = <u_N>_+^2 + a^2 |u_T|^2,   T = R_max (1 - d / d_c)^(alpha - 1),
   *   G = R_max d_c / alpha,           alpha > 1.
   *
   * alpha = 2 is the linear law; below 2 the traction falls ever steeper
   * towards d_c, above 2 it falls fastest at first. Unloading is on the secant
   * to the origin, R = T(d_m) / d_m (<u_N>_+ n + a^2 u_T).
   */
  class PprExtrinsic final : public ExtrinsicLaw
  {
  public:
    explicit PprExtrinsic(SectionReader &reader)
    {
      read_curve(reader);
      shear_weight_ = laws::read_shear_weight(reader);
    }

    double beta(const double d) const override
    {
      return std::pow(rest(d), alpha_ - 1.);
    }

    double energy(const double d) const override
    {
      return energy_increment(0., d);
    }

    /** G (y_0^alpha - y_1^alpha) with y = 1 - d / d_c. */
    double energy_increment(const double d0, const double d1) const override
    {
      if (d1 < d0)
        return -energy_increment(d1, d0);
      const double y0 = rest(d0);
      if (y0 == 0.)
        return 0.;
      // y_1 / y_0 - 1, at least -1
      const double change =
          d1 < critical_opening_ ? (d0 - d1) / (critical_opening_ - d0) : -1.;
      return -toughness() * std::pow(y0, alpha_) *
             std::expm1(alpha_ * std::log1p(change));
    }

    double toughness() const override
    {
      return strength_ * critical_opening_ / alpha_;
    }

    /** At the start; at the very end, and infinite, if alpha < 2. */
    double steepest_softening() const override
    {
      if (alpha_ < 2.)
        return std::numeric_limits<double>::infinity();
      return (alpha_ - 1.) * strength_ / critical_opening_;
    }

  private:
    double alpha_;

    /** 1 - d / d_c. */
    double rest(const double d) const
    {
      return d < critical_opening_ ? (critical_opening_ - d) / critical_opening_
                                   : 0.;
    }

    /** Three of strength, toughness, critical opening and alpha. */
    void read_curve(SectionReader &reader)
    {
      laws::Separation separation(reader);
      const bool has_alpha = reader.has("alpha");
      alpha_ = 2.;
      if (has_alpha)
        alpha_ = reader.number(
            "alpha", "", units::none,
            {1., std::numeric_limits<double>::infinity(), true, true},
            "Exponent: T = R_max (1 - d/d_c)^(alpha - 1)");

      if (separation.n_given() + has_alpha == 4)
        reader.error("alpha",
                     "`strength`, `toughness`, `critical opening` and `alpha` "
                     "are tied by G = R_max d_c / alpha and cannot all be "
                     "given",
                     "remove one of the four");
      else if (separation.n_given() + has_alpha < 3)
        reader.error("alpha",
                     "the law ppr-extrinsic needs three of `strength`, "
                     "`toughness`, `critical opening` and `alpha`",
                     "add the missing ones");
      else if (!has_alpha) {
        const double alpha =
            *separation.strength *
            (*separation.critical_opening / *separation.toughness);
        if (alpha > 1.)
          alpha_ = alpha;
        else
          reader.error("toughness",
                       "G = R_max d_c / alpha makes alpha at most 1: not a "
                       "falling curve",
                       "lower `toughness`, or raise `critical opening`");
      } else
        separation.complete(reader, "ppr-extrinsic", 1. / alpha_, "");
      strength_ = separation.strength.value_or(1.);
      critical_opening_ = separation.critical_opening.value_or(1.);
    }
  };

  NSFD_REGISTER(CohesiveLawRegistry, PprExtrinsic, "ppr-extrinsic",
                "Extrinsic, T = R_max (1 - d/d_c)^(alpha-1); from three of "
                "strength, toughness, critical opening and alpha",
                "strength = 40 MPa; toughness = 100 J/m^2; alpha = 5",
                "strength = 40 MPa; toughness = 100 J/m^2; "
                "critical opening = 3.75 um; mode mixity = 0.7");
} // namespace nsfd
