#include "linear_softening.h"

#include "nsfd/parameters/section_reader.h"

namespace nsfd
{
  /**
   * The law of Camacho and Ortiz, extrinsic and linear:
   *
   *   d^2 = <u_N>_+^2 + a^2 |u_T|^2,   T = R_max (1 - d / d_c),
   *   G = R_max d_c / 2.
   *
   * Unloading is on the secant to the origin, R = T(d_m) / d_m (<u_N>_+ n +
   * a^2 u_T): opening to d_m and closing again dissipates R_max d_m / 2. (The
   * literal form (5) of [AM06] keeps the traction while closing.) The
   * interface starts to open at the stress |<t_N>_+ n + t_T / a| = R_max.
   */
  class CamachoOrtiz final : public LinearSoftening
  {
  public:
    explicit CamachoOrtiz(SectionReader &reader)
    {
      strength_ = reader.number("strength", "", units::pressure,
                                Range::positive(), "Largest traction R_max");
      critical_opening_ = read_critical_opening(reader);
      const double a = reader.number(
          "mode mixity", "1", units::none, Range::positive(),
          "Weight a of the slip in the opening, d^2 = u_N^2 + a^2 u_T^2");
      shear_weight_ = a * a;
    }

  private:
    double read_critical_opening(SectionReader &reader) const
    {
      const bool has_toughness = reader.has("toughness");
      const bool has_opening = reader.has("critical opening");
      const double G =
          has_toughness ? reader.number("toughness", "", units::energy_per_area,
                                        Range::positive(), "Fracture energy G")
                        : 1.;
      const double opening =
          has_opening
              ? reader.number("critical opening", "", units::length,
                              Range::positive(), "Opening d_c at separation")
              : 2. * G / strength_;

      if (has_toughness && has_opening)
        reader.error("toughness",
                     "`strength`, `toughness` and `critical opening` are "
                     "tied by G = 1/2 R_max d_c and cannot all be given",
                     "remove `toughness` or `critical opening`");
      if (!has_toughness && !has_opening)
        reader.error("toughness",
                     "the law camacho-ortiz needs `toughness` or "
                     "`critical opening` besides `strength`",
                     "add one of them");
      return opening;
    }
  };

  NSFD_REGISTER(CohesiveLawRegistry, CamachoOrtiz, "camacho-ortiz",
                "Extrinsic, linear softening, secant unloading; from strength "
                "and toughness or critical opening",
                "strength = 300 MPa; toughness = 0.5 J/m^2",
                "strength = 300 MPa; critical opening = 1 um; "
                "mode mixity = 0.7");
} // namespace nsfd
