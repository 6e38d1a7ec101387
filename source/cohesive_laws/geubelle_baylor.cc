#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/cohesive_laws/law_input.h"

#include <algorithm>
#include <string>

namespace nsfd
{
  /**
   * The bilinear law of Geubelle and Baylor, intrinsic: with
   * d^2 = <u_N>_+^2 + (delta_N / delta_T)^2 |u_T|^2 and d_c = delta_N,
   *
   *   T = C d up to d_0,   T = R_max (d_c - d) / (d_c - d_0) up to d_c,
   *   d_0 = R_max / C = (1 - S_i) d_c,   G = R_max d_c / 2.
   *
   * The authors write T = S / (1 - S) d/d_c sigma_max with S = min(S_i,
   * 1 - d/d_c), whose peak is S_i sigma_max. Here `strength` is the peak; for
   * their law give S_i sigma_max ("0.98 * 300 MPa"). The law has a potential
   * only if the mixity is delta_N / delta_T, which is the default.
   */
  class GeubelleBaylor final : public CohesiveLaw
  {
  public:
    explicit GeubelleBaylor(SectionReader &reader)
    {
      laws::Separation separation(reader);
      separation.complete(reader, "geubelle-baylor", 0.5, "G = 1/2 R_max d_c");
      strength_ = *separation.strength;
      critical_opening_ = *separation.critical_opening;
      elastic_limit_ = read_elastic_limit(reader);

      const double opening_ratio =
          laws::read_opening_ratio(reader, critical_opening_);
      const std::string text =
          "Strength in shear over R_max; default delta_N / delta_T, with which "
          "the law has a potential";
      const double mixity = reader.optional("mixity", text)
                                ? reader.number("mixity", "", units::none,
                                                Range::positive(), text)
                                : opening_ratio;
      stiffness_ratio_ = mixity * opening_ratio;
      shear_weight_ = opening_ratio * opening_ratio;
    }

    bool extrinsic() const override { return false; }
    double normal_stiffness() const override
    {
      return strength_ / elastic_limit_;
    }
    double stiffness_ratio() const override { return stiffness_ratio_; }
    double shear_weight() const override { return shear_weight_; }

    double beta(const double d) const override
    {
      if (d <= elastic_limit_)
        return 1.;
      return std::min(1., elastic_limit_ * rest(d) / d);
    }

    double traction(const double d) const override
    {
      if (d <= elastic_limit_)
        return strength_ * (d / elastic_limit_);
      return strength_ * rest(d);
    }

    double energy(const double d) const override
    {
      if (d <= elastic_limit_)
        return 0.5 * traction(d) * d;
      if (d >= critical_opening_)
        return toughness();
      return toughness() - 0.5 * traction(d) * (critical_opening_ - d);
    }

    double elastic_limit() const override { return elastic_limit_; }
    double peak_opening() const override { return elastic_limit_; }
    double final_opening() const override { return critical_opening_; }
    double strength() const override { return strength_; }

    double toughness() const override
    {
      return 0.5 * strength_ * critical_opening_;
    }

    double steepest_softening() const override
    {
      return strength_ / (critical_opening_ - elastic_limit_);
    }

  private:
    double strength_, critical_opening_, elastic_limit_;
    double stiffness_ratio_, shear_weight_;

    /** T / R_max on the falling branch. */
    double rest(const double d) const
    {
      if (d >= critical_opening_)
        return 0.;
      return (critical_opening_ - d) / (critical_opening_ - elastic_limit_);
    }

    double read_elastic_limit(SectionReader &reader) const
    {
      const bool has_stiffness = reader.has("stiffness"),
                 has_parameter = reader.has("initial strength parameter");
      double result = 0.5 * critical_opening_;
      if (has_stiffness)
        result = strength_ /
                 reader.number("stiffness", "", units::stiffness_per_area,
                               Range::positive(), "Normal stiffness C_N");
      if (has_parameter)
        result =
            critical_opening_ *
            (1. - reader.number("initial strength parameter", "", units::none,
                                {0., 1., true, true}, "S_i = 1 - d_0 / d_c"));

      if (has_stiffness && has_parameter)
        reader.error("stiffness",
                     "`stiffness` and `initial strength parameter` are tied by "
                     "C = R_max / ((1 - S_i) d_c) and cannot both be given",
                     "remove one of the two");
      else if (!has_stiffness && !has_parameter)
        reader.error("stiffness",
                     "the law geubelle-baylor needs `stiffness` or `initial "
                     "strength parameter`",
                     "add one of them");
      else if (!(result < critical_opening_))
        reader.error("stiffness",
                     "the traction peaks at R_max / C, which is not below the "
                     "critical opening 2 G / R_max",
                     "raise `stiffness`");
      else
        return result;
      return 0.5 * critical_opening_;
    }
  };

  NSFD_REGISTER(CohesiveLawRegistry, GeubelleBaylor, "geubelle-baylor",
                "Intrinsic, bilinear; from two of strength, toughness and "
                "critical opening, and stiffness or S_i",
                "strength = 3 MPa; toughness = 4 J/m^2; "
                "initial strength parameter = 0.98",
                "strength = 3 MPa; critical opening = 2 um; stiffness = 1e13; "
                "tangential critical opening = 5 um; mixity = 1.5");
} // namespace nsfd
