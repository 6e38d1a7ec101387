#include "gauss.h"
#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/cohesive_laws/law_input.h"

#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    /** (1 + x) e^-x, finite for every x. */
    double area_left(const double x)
    {
      return x < 700. ? (1. + x) * std::exp(-x) : 0.;
    }

    /** Both directions of the law XuNeedleman. */
    class XuNeedlemanModes final : public MixedLaw
    {
    public:
      XuNeedlemanModes(const double strength, const double opening,
                       const double slip)
          : strength_(strength), opening_(opening), slip_(slip)
      {
      }

      double normal_stiffness() const
      {
        return std::exp(1.) * strength_ / opening_;
      }
      double toughness() const { return std::exp(1.) * strength_ * opening_; }

      double normal_secant(const double x, const double y) const override
      {
        return normal_stiffness() * std::exp(-x / opening_) * fade(y);
      }
      double tangential_secant(const double x, const double y) const override
      {
        return tangential_stiffness() * area_left(x / opening_) * fade(y);
      }

      double normal_energy(const double x0, const double x1,
                           const double y) const override
      {
        // in units of delta_N: the rule of integrate() is exact to round-off
        constexpr double close = 0.25;
        const double a = x0 / opening_, b = x1 / opening_;
        const double share =
            std::abs(b - a) < close
                ? integrate([](const double x) { return x * std::exp(-x); }, a,
                            b)
                : area_left(a) - area_left(b);
        return toughness() * fade(y) * share;
      }
      double tangential_energy(const double y0, const double y1,
                               const double x) const override
      {
        const double a = y0 / slip_, b = y1 / slip_;
        return toughness() * area_left(x / opening_) * std::exp(-a * a) *
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

      double tangential_stiffness() const
      {
        return 2. * toughness() / (slip_ * slip_);
      }
      double fade(const double y) const
      {
        return std::exp(-(y / slip_) * (y / slip_));
      }
    };
  } // namespace

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
  class XuNeedleman final : public CohesiveLaw
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
      modes_ = {strength_, opening_, slip_};
    }

    bool extrinsic() const override { return false; }
    double normal_stiffness() const override
    {
      return modes_.normal_stiffness();
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
      return modes_.normal_energy(0., d, 0.);
    }
    double energy_increment(const double d0, const double d1) const override
    {
      return modes_.normal_energy(d0, d1, 0.);
    }

    double elastic_limit() const override { return 0.; }
    double peak_opening() const override { return opening_; }
    double final_opening() const override
    {
      return std::numeric_limits<double>::infinity();
    }
    double strength() const override { return strength_; }
    double toughness() const override { return modes_.toughness(); }

    /** At 2 delta_N. */
    double steepest_softening() const override
    {
      return strength_ / (std::exp(1.) * opening_);
    }

    const MixedLaw *mixed() const override { return &modes_; }

  private:
    double strength_, opening_, slip_;
    XuNeedlemanModes modes_{1., 1., 1.};

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
        return std::sqrt(2. / std::exp(1.)) *
               (std::exp(1.) * strength_ * opening_) / *shear;
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
