#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/parameters/section_reader.h"

#include <string>

namespace nsfd
{
  /**
   * Tvergaard's law, equations (12)-(17) of [AM06], intrinsic:
   *
   *   lambda^2 = (<u_N>_+ / delta_N)^2 + (|u_T| / delta_T)^2,
   *   beta = <1 - lambda>_+^2,
   *   C_N = 27 R_max / (4 delta_N),   C_T = 27 i R_max / (4 delta_T),
   *
   * hence d = delta_N lambda and G = 9/16 R_max delta_N. The positive part in
   * beta is missing in the print of (17). The law has a potential only if
   * i = delta_N / delta_T, which is the default.
   */
  class Tvergaard final : public CohesiveLaw
  {
  public:
    explicit Tvergaard(SectionReader &reader)
    {
      strength_ = reader.number("strength", "", units::pressure,
                                Range::positive(), "Largest traction R_max");
      critical_opening_ = read_critical_opening(reader);

      const std::string opening_text =
          "Slip delta_T at full separation; default delta_N";
      const double tangential_opening =
          reader.optional("tangential critical opening", opening_text)
              ? reader.number("tangential critical opening", "", units::length,
                              Range::positive(), opening_text)
              : critical_opening_;
      const double opening_ratio = critical_opening_ / tangential_opening;
      const std::string mixity_text =
          "Strength in shear over R_max; default delta_N / delta_T, with which "
          "the law has a potential";
      const double mixity = reader.optional("mixity", mixity_text)
                                ? reader.number("mixity", "", units::none,
                                                Range::positive(), mixity_text)
                                : opening_ratio;

      normal_stiffness_ = 27. * strength_ / (4. * critical_opening_);
      stiffness_ratio_ = mixity * opening_ratio;
      shear_weight_ = opening_ratio * opening_ratio;
    }

    bool extrinsic() const override { return false; }
    double normal_stiffness() const override { return normal_stiffness_; }
    double stiffness_ratio() const override { return stiffness_ratio_; }
    double shear_weight() const override { return shear_weight_; }

    double beta(const double d) const override
    {
      if (d >= critical_opening_)
        return 0.;
      const double rest = 1. - d / critical_opening_;
      return rest * rest;
    }

    double traction(const double d) const override
    {
      return beta(d) * normal_stiffness_ * d;
    }

    double energy(const double d) const override
    {
      if (d >= critical_opening_)
        return toughness();
      const double x = d / critical_opening_;
      return normal_stiffness_ * d * d * (1. / 2. - 2. / 3. * x + x * x / 4.);
    }

    double elastic_limit() const override { return 0.; }
    double peak_opening() const override { return critical_opening_ / 3.; }
    double final_opening() const override { return critical_opening_; }
    double strength() const override { return strength_; }

    double toughness() const override
    {
      return 9. / 16. * strength_ * critical_opening_;
    }

    /** At 2/3 of the critical opening. */
    double steepest_softening() const override
    {
      return 2.25 * strength_ / critical_opening_;
    }

  private:
    double strength_, critical_opening_;
    double normal_stiffness_, stiffness_ratio_, shear_weight_;

    double read_critical_opening(SectionReader &reader) const
    {
      const bool has_toughness = reader.has("toughness");
      const bool has_opening = reader.has("critical opening");
      const double G =
          has_toughness ? reader.number("toughness", "", units::energy_per_area,
                                        Range::positive(), "Fracture energy G")
                        : 1.;
      const double opening =
          has_opening ? reader.number("critical opening", "", units::length,
                                      Range::positive(),
                                      "Opening delta_N at separation")
                      : 16. * G / (9. * strength_);

      if (has_toughness && has_opening)
        reader.error("toughness",
                     "`strength`, `toughness` and `critical opening` are "
                     "tied by G = 9/16 R_max delta_N and cannot all be given",
                     "remove `toughness` or `critical opening`");
      if (!has_toughness && !has_opening)
        reader.error("toughness",
                     "the law tvergaard needs `toughness` or "
                     "`critical opening` besides `strength`",
                     "add one of them");
      return opening;
    }
  };

  NSFD_REGISTER(CohesiveLawRegistry, Tvergaard, "tvergaard",
                "Intrinsic, beta = (1 - lambda)^2, (12)-(17); from strength "
                "and toughness or critical opening",
                "strength = 3 MPa; critical opening = 2 um",
                "strength = 3 MPa; toughness = 4 J/m^2; "
                "tangential critical opening = 5 um",
                "strength = 3 MPa; toughness = 4 J/m^2; "
                "tangential critical opening = 5 um; mixity = 1.5");
} // namespace nsfd
