#include "gauss.h"
#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/cohesive_laws/law_input.h"

#include <cmath>
#include <limits>

namespace nsfd
{
  /**
   * The exponential law of Xu and Needleman with equal energies in both modes
   * (q = 1, r = 0). With x = <u_N>_+ / delta_N, y = |u_T| / delta_T and
   * phi = e R_max delta_N = G, the gradient of its potential is
   *
   *   T_N = (phi / delta_N) x e^(-x - y^2),
   *   T_T = (2 phi / delta_T) y (1 + x) e^(-x - y^2).
   *
   * One damage scalar cannot say this. Here the normal secant has
   * beta_N = e^(-x - y^2) and the tangential one beta_T = (1 + x) e^(-x - y^2),
   * each of the largest x and y so far: unloading goes to the origin, which is
   * not a part of the potential. Compression is left to the contact. The peak
   * in shear is sqrt(2/e) phi / delta_T at y = 1/sqrt(2).
   */
  class XuNeedleman final : public CohesiveLaw, public MixedLaw
  {
  public:
    explicit XuNeedleman(SectionReader &reader)
    {
      laws::Separation separation(reader, "characteristic opening",
                                  "Opening delta_N at the largest traction");
      separation.complete(reader, "xu-needleman", std::exp(1.),
                          "G = e R_max delta_N");
      strength_ = *separation.strength;
      opening_ = *separation.critical_opening;
      slip_ = read_slip(reader);
    }

    bool extrinsic() const override { return false; }
    double normal_stiffness() const override
    {
      return std::exp(1.) * strength_ / opening_;
    }
    double stiffness_ratio() const override { return 2. * shear_weight(); }
    double shear_weight() const override
    {
      return (opening_ / slip_) * (opening_ / slip_);
    }

    double beta(const double d) const override
    {
      return std::exp(-d / opening_);
    }
    double traction(const double d) const override
    {
      return normal_stiffness() * d * beta(d);
    }
    double energy(const double d) const override
    {
      return normal_energy(0., d, 0.);
    }
    double energy_increment(const double d0, const double d1) const override
    {
      return normal_energy(d0, d1, 0.);
    }

    double elastic_limit() const override { return 0.; }
    double peak_opening() const override { return opening_; }
    double final_opening() const override
    {
      return std::numeric_limits<double>::infinity();
    }
    double strength() const override { return strength_; }
    double toughness() const override
    {
      return std::exp(1.) * strength_ * opening_;
    }

    /** At 2 delta_N. */
    double steepest_softening() const override
    {
      return strength_ / (std::exp(1.) * opening_);
    }

    const MixedLaw *mixed() const override { return this; }

    double normal_secant(const double x, const double y) const override
    {
      return normal_stiffness() * std::exp(-x / opening_) * fade(y);
    }
    double tangential_secant(const double x, const double y) const override
    {
      return tangential_stiffness() * rest(x / opening_) * fade(y);
    }

    double normal_energy(const double x0, const double x1,
                         const double y) const override
    {
      const double a = x0 / opening_, b = x1 / opening_;
      const double share =
          std::abs(b - a) < close
              ? integrate([](const double x) { return x * std::exp(-x); }, a, b)
              : rest(a) - rest(b);
      return toughness() * fade(y) * share;
    }
    double tangential_energy(const double y0, const double y1,
                             const double x) const override
    {
      const double a = y0 / slip_, b = y1 / slip_;
      return toughness() * rest(x / opening_) * std::exp(-a * a) *
             -std::expm1((a - b) * (a + b));
    }

    double peak_slip() const override { return slip_ / std::sqrt(2.); }

    /** At y = sqrt(3/2): T_T = (2 phi / delta_T) y e^(-y^2). */
    double steepest_shear_softening() const override
    {
      return 2. * tangential_stiffness() * std::exp(-1.5);
    }

  private:
    double strength_, opening_, slip_;

    /** In units of delta_N: the rule of integrate() is exact to round-off. */
    static constexpr double close = 0.25;

    double tangential_stiffness() const
    {
      return 2. * toughness() / (slip_ * slip_);
    }
    double fade(const double y) const
    {
      return std::exp(-(y / slip_) * (y / slip_));
    }
    /** (1 + x) e^-x, finite for every x. */
    static double rest(const double x)
    {
      return x < 700. ? (1. + x) * std::exp(-x) : 0.;
    }

    double read_slip(SectionReader &reader) const
    {
      const auto slip =
          laws::given(reader, "characteristic slip", units::length,
                      "Slip delta_T; default delta_N");
      const auto shear = laws::given(reader, "shear strength", units::pressure,
                                     "Largest traction in shear");
      if (slip && shear)
        reader.error("shear strength",
                     "`shear strength` and `characteristic slip` are tied by "
                     "tau = sqrt(2/e) G / delta_T and cannot both be given",
                     "remove one of the two");
      if (shear)
        return std::sqrt(2. / std::exp(1.)) * toughness() / *shear;
      return slip.value_or(opening_);
    }
  };

  NSFD_REGISTER(CohesiveLawRegistry, XuNeedleman, "xu-needleman",
                "Intrinsic, exponential, two damage scalars, endless tail; "
                "from two of strength, toughness and characteristic opening",
                "strength = 3 MPa; toughness = 4 J/m^2",
                "strength = 3 MPa; characteristic opening = 0.5 um; "
                "shear strength = 5 MPa");
} // namespace nsfd
