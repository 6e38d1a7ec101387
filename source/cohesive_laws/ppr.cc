#include "gauss.h"
#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/cohesive_laws/law_input.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    /**
     * One direction of the law: with z = u / delta,
     *
     *   g(z) = (c + z)^m (1 - z)^alpha / c^m,   c = m / alpha,
     *
     * falls from 1 at z = 0, where it has no slope, to 0 at z = 1; the traction
     * of that direction alone is -phi g'(z) / delta, with its largest value at
     * z = l: m = alpha (alpha - 1) l^2 / (1 - alpha l^2).
     */
    struct Shape {
      double alpha = 3., l = 0.1; ///< exponent, place of the peak
      double m = 0., c = 0.;

      Shape() = default;
      Shape(const double exponent, const double peak)
          : alpha(exponent), l(peak),
            m(alpha * (alpha - 1.) * l * l / (1. - alpha * l * l)), c(m / alpha)
      {
      }

      double g(const double z) const
      {
        return z < 1. ? std::pow(1. + z / c, m) * std::pow(1. - z, alpha) : 0.;
      }

      /** -g'(z) / z: never grows with z if m <= alpha. */
      double secant(const double z) const
      {
        return z < 1. ? (m + alpha) / c * std::pow(1. + z / c, m - 1.) *
                            std::pow(1. - z, alpha - 1.)
                      : 0.;
      }

      /** g(a) - g(b) without cancellation. */
      double fall(const double a, const double b) const
      {
        if (b < a)
          return -fall(b, a);
        // far enough from z = -c and z = 1 for the rule
        if (b - a < 0.2 * std::min(a + c, 1. - b))
          return integrate([this](const double z) { return z * secant(z); }, a,
                           b);
        return g(a) - g(b);
      }

      /** max |d(z secant)/dz|; infinite at z = 1 if alpha < 2. */
      double steepest() const
      {
        if (alpha < 2.)
          return std::numeric_limits<double>::infinity();
        const auto slope = [this](const double z) {
          const double p = c + z, q = 1. - z;
          return -(m + alpha) / c * std::pow(p / c, m - 2.) *
                 std::pow(q, alpha - 2.) *
                 (q * p + (m - 1.) * z * q - (alpha - 1.) * z * p) / c;
        };
        double best = 0., at = l;
        const unsigned int n = 2000;
        for (unsigned int i = 0; i <= n; ++i) {
          const double z = l + (1. - l) * i / n;
          if (slope(z) > best) {
            best = slope(z);
            at = z;
          }
        }
        double low = std::max(l, at - (1. - l) / n),
               high = std::min(1., at + (1. - l) / n);
        for (unsigned int k = 0; k < 60; ++k) {
          const double a = low + (high - low) / 3.,
                       b = high - (high - low) / 3.;
          (slope(a) < slope(b) ? low : high) = slope(a) < slope(b) ? a : b;
        }
        return std::max(best, slope(0.5 * (low + high)));
      }
    };

    /**
     * Both directions of the law Ppr: toughness phi, shape and final opening of
     * each.
     */
    class PprModes final : public MixedLaw
    {
    public:
      struct Mode {
        double toughness = 1.;
        Shape shape;
        double end = 1.; ///< delta

        Mode() = default;
        /** delta has the peak of -phi g'(z) / delta at @p strength. */
        Mode(const double phi, const Shape &g, const double strength)
            : toughness(phi), shape(g),
              end(phi * g.l * g.secant(g.l) / strength)
        {
        }
      };

      PprModes() = default;
      PprModes(const Mode &opening, const Mode &shear)
          : opening_(opening), shear_(shear)
      {
      }

      const Mode &opening() const { return opening_; }
      const Mode &shear() const { return shear_; }

      double normal_secant(const double x, const double y) const override
      {
        return opening_.shape.secant(x / opening_.end) * left_by_slip(y) /
               (opening_.end * opening_.end);
      }
      double tangential_secant(const double x, const double y) const override
      {
        return shear_.shape.secant(y / shear_.end) * left_by_opening(x) /
               (shear_.end * shear_.end);
      }
      double normal_energy(const double x0, const double x1,
                           const double y) const override
      {
        return opening_.shape.fall(x0 / opening_.end, x1 / opening_.end) *
               left_by_slip(y);
      }
      double tangential_energy(const double y0, const double y1,
                               const double x) const override
      {
        return shear_.shape.fall(y0 / shear_.end, y1 / shear_.end) *
               left_by_opening(x);
      }
      double peak_slip() const override { return shear_.shape.l * shear_.end; }
      double steepest_shear_softening() const override
      {
        return shear_.toughness / (shear_.end * shear_.end) *
               shear_.shape.steepest();
      }

    private:
      Mode opening_, shear_;

      /** Energy that a slip leaves to opening. */
      double left_by_slip(const double y) const
      {
        return left(opening_.toughness, shear_.toughness,
                    shear_.shape.g(y / shear_.end));
      }
      double left_by_opening(const double x) const
      {
        return left(shear_.toughness, opening_.toughness,
                    opening_.shape.g(x / opening_.end));
      }
      static double left(const double mine, const double other, const double g)
      {
        return mine < other ? std::max(0., mine - other * (1. - g)) : mine * g;
      }
    };

    /** In shear the default is what holds in opening, @p other. */
    Shape read_shape(SectionReader &reader, const std::string &mode,
                     const std::string &alpha_default,
                     const std::string &peak_default, const Shape &other)
    {
      const bool is_normal = mode.empty();
      const std::string alpha_name = mode + "alpha",
                        peak_name = mode + "peak ratio";
      const std::string alpha_text =
          "Exponent of the curve towards separation, above 1";
      const std::string peak_text = "Opening at the peak over the final one";
      const Range above_one{1., std::numeric_limits<double>::infinity(), true,
                            true};
      const Range share{0., 1., true, true};
      double alpha = other.alpha, peak = other.l;
      if (is_normal ||
          reader.optional(alpha_name, alpha_text + "; default alpha"))
        alpha = reader.number(alpha_name, alpha_default, units::none, above_one,
                              alpha_text);
      if (is_normal ||
          reader.optional(peak_name, peak_text + "; default peak ratio"))
        peak = reader.number(peak_name, peak_default, units::none, share,
                             peak_text);
      // m <= alpha: beyond, the secant would grow at first
      const double largest = 1. / std::sqrt(2. * alpha - 1.);
      if (!(peak <= largest)) {
        reader.error(peak_name,
                     "the peak is so late that the secant grows at first: "
                     "not damage",
                     "write less than 1 / sqrt(2 alpha - 1)");
        peak = 0.5 * largest;
      }
      return {alpha, peak};
    }
  } // namespace

  /**
   * The intrinsic law of Park, Paulino and Roesler (2009), two damage scalars.
   * With g_N(x), g_T(y) of x = <u_N>_+ / delta_N and y = |u_T| / delta_T, and
   * toughnesses phi_N and phi_T in opening and in shear,
   *
   *   T_N = -g_N'(x) <phi_T g_T(y) - <phi_T - phi_N>_+>_+ / delta_N  (phi_N <
   * phi_T) T_T = -g_T'(y) <phi_N g_N(x) - <phi_N - phi_T>_+>_+ / delta_T
   *
   * and phi g of the other direction where its toughness is the larger one: the
   * gradient of their potential. Each strength fixes its final opening. Secants
   * are those of the largest x and y so far; unloading goes to the origin.
   */
  class Ppr final : public CohesiveLaw
  {
  public:
    explicit Ppr(SectionReader &reader)
    {
      strength_ = reader.number("strength", "", units::pressure,
                                Range::positive(), "Largest traction R_max");
      const double toughness =
          reader.number("toughness", "", units::energy_per_area,
                        Range::positive(), "Fracture energy in opening");
      const double shear_strength =
          laws::given(reader, "shear strength", units::pressure,
                      "Largest traction in shear; default R_max")
              .value_or(strength_);
      const double shear_toughness =
          laws::given(reader, "shear toughness", units::energy_per_area,
                      "Fracture energy in shear; default that in opening")
              .value_or(toughness);
      const Shape normal = read_shape(reader, "", "3", "0.1", {});
      const Shape shear = read_shape(reader, "shear ", "", "", normal);
      modes_ = {{toughness, normal, strength_},
                {shear_toughness, shear, shear_strength}};
    }

    bool extrinsic() const override { return false; }
    double normal_stiffness() const override
    {
      return modes_.normal_secant(0., 0.);
    }
    double stiffness_ratio() const override
    {
      return modes_.tangential_secant(0., 0.) / modes_.normal_secant(0., 0.);
    }
    double shear_weight() const override
    {
      const double ratio = modes_.opening().end / modes_.shear().end;
      return ratio * ratio;
    }

    double beta(const double d) const override
    {
      const PprModes::Mode &mode = modes_.opening();
      return mode.shape.secant(d / mode.end) / mode.shape.secant(0.);
    }
    double traction(const double d) const override
    {
      return modes_.normal_secant(d, 0.) * d;
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
    double peak_opening() const override
    {
      return modes_.opening().shape.l * modes_.opening().end;
    }
    double final_opening() const override { return modes_.opening().end; }
    double strength() const override { return strength_; }
    double toughness() const override { return modes_.opening().toughness; }
    double steepest_softening() const override
    {
      const PprModes::Mode &mode = modes_.opening();
      return mode.toughness / (mode.end * mode.end) * mode.shape.steepest();
    }

    const MixedLaw *mixed() const override { return &modes_; }

  private:
    double strength_;
    PprModes modes_;
  };

  NSFD_REGISTER(
      CohesiveLawRegistry, Ppr, "ppr",
      "Intrinsic, of Park, Paulino and Roesler, two damage scalars; "
      "strength and toughness of each mode",
      "strength = 40 MPa; toughness = 100 J/m^2",
      "strength = 40 MPa; toughness = 100 J/m^2; shear strength = 30 "
      "MPa; shear toughness = 200 J/m^2; alpha = 5; peak ratio = 0.1; "
      "shear alpha = 1.3; shear peak ratio = 0.2",
      "strength = 40 MPa; toughness = 300 J/m^2; shear strength = 30 "
      "MPa; shear toughness = 200 J/m^2; alpha = 2.5; shear alpha = "
      "3; shear peak ratio = 0.05");
} // namespace nsfd
