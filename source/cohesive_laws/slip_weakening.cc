#include "linear_softening.h"

#include "nsfd/parameters/section_reader.h"

#include <algorithm>

namespace nsfd
{
  /**
   * Linear slip weakening (Ida, J. Geophys. Res. 77, 1972; Andrews, the same
   * 81, 1976) of a fault under a normal traction sigma_n, as cohesion on top of
   * Coulomb friction:
   *
   *   |t_T| <= mu_d p_N + (mu_s - mu_d) sigma_n (1 - |u_T| / D_c),
   *
   * the friction of the block with mu_d and the current pressure p_N, and full
   * from the start (friction exponent 0). While p_N = sigma_n, slip begins at
   * mu_s sigma_n and goes on at mu_d sigma_n after D_c. Extrinsic; unloading is
   * on the secant to the origin. What opens has the strength R_max in
   * traction: with r = (mu_s - mu_d) sigma_n / R_max
   *
   *   d^2 = <u_N>_+^2 + r^2 |u_T|^2,   T = R_max (1 - d / (r D_c)),
   *   G = (mu_s - mu_d) sigma_n D_c / 2.
   */
  class SlipWeakening final : public LinearSoftening
  {
  public:
    explicit SlipWeakening(SectionReader &reader)
    {
      const double mu_d =
          reader.number("friction", "0", units::none, Range::non_negative(),
                        "coefficient of Coulomb friction");
      const double mu_s = reader.number(
          "static friction", "", units::none, Range::positive(),
          "mu_s, above `friction`: slip begins at mu_s times the normal "
          "traction");
      if (!(mu_s > mu_d))
        reader.error("static friction",
                     "the law slip-weakening falls from static friction to "
                     "friction, which is not smaller",
                     "write a larger static friction");
      const double sigma = reader.number(
          "normal traction", "", units::pressure, Range::positive(),
          "sigma_n in Pa, pressure positive, of the cohesion (mu_s - mu_d) "
          "sigma_n");
      const double slip =
          reader.number("slip distance", "", units::length, Range::positive(),
                        "D_c in m, over which it falls to 0");
      const double cohesion = std::max(mu_s - mu_d, 1e-6) * sigma;
      const std::string name = "opening strength",
                        text = "Pa in pure opening; default: the cohesion";
      strength_ = reader.optional(name, text)
                      ? reader.number(name, "", units::pressure,
                                      Range::positive(), text)
                      : cohesion;
      // r: strength in slip over that in opening
      const double ratio = cohesion / strength_;
      critical_opening_ = ratio * slip;
      shear_weight_ = ratio * ratio;
    }

    double friction_exponent() const override { return 0.; }
  };

  NSFD_REGISTER(CohesiveLawRegistry, SlipWeakening, "slip-weakening",
                "Extrinsic, linear slip weakening of a fault: cohesion (mu_s - "
                "mu_d) sigma_n over D_c, on top of friction mu_d",
                "static friction = 0.677; normal traction = 120 MPa; slip "
                "distance = 0.4 m",
                "static friction = 0.9; normal traction = 10 MPa; slip "
                "distance = 1 mm; opening strength = 1 MPa");
} // namespace nsfd
