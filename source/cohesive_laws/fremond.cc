#include "core/bracketed_root.h"
#include "gauss.h"
#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/cohesive_laws/law_input.h"
#include "parameters/parameter_file.h"
#include "power_series.h"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace nsfd
{
  namespace
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();

    /**
     * What rests on the functions f and g of the law Fremond: where damage goes
     * on, and the traction there.
     */
    class AdhesionCurve
    {
    public:
      AdhesionCurve() = default;
      AdhesionCurve(const double stiffness, const double energy,
                    const PowerSeries &f, const PowerSeries &g)
          : stiffness_(stiffness), energy_(energy), f_(f), g_(g)
      {
        tabulate();
      }

      /** The intensity jumps somewhere. */
      bool jumps() const { return jumps_; }

      double elastic_limit() const { return std::sqrt(squares_[0]); }
      /** The first number without any traction. */
      double final_opening() const
      {
        const double end = std::sqrt(squares_.back());
        return end > elastic_limit() ? end : std::nextafter(end, infinity);
      }

      double stiffness_at(const double b) const
      {
        return b > 0. ? std::min(1., std::max(0., f_.value(b))) : 0.;
      }

      double traction_at(const double b) const
      {
        return stiffness_at(b) * stiffness_ * opening_at(b);
      }

      /** The largest opening of a point of this intensity. */
      double opening_at(const double b) const
      {
        return std::sqrt(std::max(squares_[0], square_at(b)));
      }

      /** Energy w g(b) that is spent. */
      double spent(const double b) const { return energy_ * g_.value(1. - b); }

      /** The intensity after db/dt = -g'(b), of the time 1, from @p b. */
      double healed(double b, const double time) const
      {
        // beyond, what has not come to 1 rests where g' is 0
        constexpr double long_time = 40.;
        constexpr unsigned int n_steps = 64;
        const double h = std::min(time, long_time) / n_steps;
        // beyond 1 as at 1: a rate that ends there would end within a step
        const auto rate = [&](const double x) {
          return std::max(0., g_.first(1. - std::min(x, 1.)));
        };
        for (unsigned int k = 0; k < n_steps && b < 1.; ++k) {
          const double k1 = rate(b), k2 = rate(b + h / 2. * k1),
                       k3 = rate(b + h / 2. * k2), k4 = rate(b + h * k3);
          b += h / 6. * (k1 + 2. * k2 + 2. * k3 + k4);
        }
        return std::min(1., b);
      }

      /** The driving force chi = d psi / d b at the opening @p d. */
      double driving_force(const double b, const double d) const
      {
        return f_.first(b) * stiffness_ * d * d / 2. -
               energy_ * g_.first(1. - b);
      }

      /** The intensity of the largest traction. */
      double peak_intensity() const
      {
        return place_of_largest(
            [this](const double b) { return traction_at(b); });
      }

      /** dT/dd = f C + 2 C d^2 f' / (d^2)', where damage is gradual. */
      double steepest_softening() const
      {
        if (jumps_)
          return infinity;
        const auto softening = [&](const double b) {
          const double slope = f_.first(b), square = square_at(b);
          const double change = // d(d^2)/db < 0
              -square *
              (g_.second(1. - b) / g_.first(1. - b) + f_.second(b) / slope);
          return -(stiffness_at(b) + 2. * square * slope / change) * stiffness_;
        };
        return softening(place_of_largest(softening));
      }

      /** Where damage stops at the opening @p d. */
      double intensity(const double d) const
      {
        const double square = d * d;
        if (d >= final_opening() || square >= squares_.back())
          return 0.;
        const std::size_t k =
            std::upper_bound(squares_.begin(), squares_.end(), square) -
            squares_.begin();
        if (k == 0)
          return 1.;
        const double low = node(k), width = node(k - 1) - low;
        const auto excess = [&](const double x) {
          return std::min(square_at(low + x), 1e300) - square;
        };
        const double f_low = excess(0.), f_high = excess(width);
        if (f_high >= 0.)
          return node(k - 1);
        return low + bracketed_root(excess, 0., width, f_low, f_high);
      }

      /** -2 w g'(b) / (C f'(b)). */
      double square_at(const double b) const
      {
        const double slope = f_.first(b), driving = g_.first(1. - b);
        if (driving <= 0.)
          return 0.;
        return slope > 0. ? 2. * energy_ * driving / (stiffness_ * slope)
                          : infinity;
      }

    private:
      double stiffness_ = 1., energy_ = 1.;
      PowerSeries f_, g_; ///< g of 1 - b
      /** d^2 at b = 1 - k / n, its largest value so far: damage goes on there.
       */
      std::vector<double> squares_;
      bool jumps_ = false;

      double node(const std::size_t k) const
      {
        return 1. - double(k) / double(squares_.size() - 1);
      }

      void tabulate()
      {
        const unsigned int n = 1000;
        std::vector<double> squares(n + 1);
        for (unsigned int k = 0; k <= n; ++k)
          squares[k] = square_at(1. - double(k) / n);
        for (unsigned int k = 1; k <= n; ++k) {
          if (!(squares[k] > squares[k - 1] * (1. + 1e-9)))
            jumps_ = true;
          squares[k] = std::max(squares[k], squares[k - 1]);
        }
        squares_ = squares;
      }

      /** Largest value of @p f over intensities, refined between nodes. */
      template <typename Function>
      double place_of_largest(const Function &f) const
      {
        std::size_t best = 0;
        double largest = f(1.);
        for (std::size_t k = 1; k + 1 < squares_.size(); ++k)
          if (const double value = f(node(k)); value > largest * (1. + 1e-12)) {
            largest = value;
            best = k;
          }
        if (best == 0)
          return 1.;
        double low = node(best + 1), high = node(best - 1);
        for (unsigned int k = 0; k < 80; ++k) {
          const double a = low + (high - low) / 3.,
                       b = high - (high - low) / 3.;
          (f(a) < f(b) ? low : high) = f(a) < f(b) ? a : b;
        }
        return 0.5 * (low + high);
      }
    };

    /** Of beta, or of 1 - beta: rising from 0 to 1. */
    PowerSeries read_function(SectionReader &reader, const std::string &name,
                              const std::string &default_text,
                              const std::string &text, const bool mirrored)
    {
      const auto value = reader.raw(name, default_text, text, default_text);
      const std::string formula = value ? value->text() : default_text;
      try {
        double beta = 0.5;
        mu::Parser parser;
        parser.DefineVar("beta", &beta);
        parser.SetExpr(formula);
        const auto f = [&](const double x) {
          beta = mirrored ? 1. - x : x;
          return parser.Eval();
        };
        if (std::abs(f(0.)) > 1e-12 || std::abs(f(1.) - 1.) > 1e-12)
          throw std::runtime_error(fmt::format(
              "is {:g} at beta = 0 and {:g} at beta = 1, not {} and {}",
              f(mirrored ? 1. : 0.), f(mirrored ? 0. : 1.), mirrored ? 1 : 0,
              mirrored ? 0 : 1));
        const PowerSeries series = PowerSeries::of(f);
        for (unsigned int k = 1; k <= 200; ++k)
          if (series.first(k / 200.) < -1e-9)
            throw std::runtime_error(mirrored ? "rises somewhere"
                                              : "falls somewhere");
        return series;
      } catch (const mu::Parser::exception_type &error) {
        reader.error(name,
                     fmt::format("{} = {}: {}", name, formula, error.GetMsg()),
                     "write a formula of `beta`, for example: " + default_text);
      } catch (const std::runtime_error &error) {
        reader.error(name,
                     fmt::format("{} = {} {}", name, formula, error.what()),
                     "write for example: " + default_text);
      }
      return PowerSeries::of([](const double x) { return x; });
    }
  } // namespace

  /**
   * The thermodynamic form (7)-(11) of [AM06] after Fremond, for any free
   * energy and pseudo-potential of the kind
   *
   *   psi(b, u) = f(b) C d^2 / 2 - w (1 - g(b)),  C d^2 = C_N <u_N>_+^2 +
   *                                                       C_T |u_T|^2,
   *   chi = d psi / d b,   db/dt in -d Lambda(chi),
   *
   * b the adhesion intensity from 1 to 0, f (`stiffness function`) from 0 at
   * b = 0 to 1 at b = 1, g (`surface energy function`) from 1 down to 0, and
   * Lambda the indicator of chi <= 0 (rate independent) or <chi>_+^2 / (2 eta)
   * (`damage viscosity` eta). The traction is f(b) C u, so beta = f(b), and
   * G = w. Damage goes on where
   *
   *   d^2 = -2 w g'(b) / (C f'(b)),
   *
   * at once from b to the next such place if that falls with b. f = b^2 and
   * g = 1 - b is the adhesion of Raous, Cangemi and Cocu, f = b and g = 1 - b
   * perfectly brittle. With a healing time tau the intensity grows again where
   * the face is pressed and chi = w g'(b) < 0: db/dt = -g'(b) min(1,
   * p/p_h)/tau.
   */
  class Fremond final : public CohesiveLaw
  {
  public:
    explicit Fremond(SectionReader &reader)
    {
      stiffness_ = reader.number("stiffness", "", units::stiffness_per_area,
                                 Range::positive(), "Normal stiffness C_N");
      energy_ = reader.number("adhesion energy", "", units::energy_per_area,
                              Range::positive(), "Adhesion energy w = G");
      stiffness_ratio_ = laws::read_stiffness_ratio(reader, stiffness_);
      viscosity_ = reader.number("damage viscosity", "0",
                                 units::damage_viscosity, Range::non_negative(),
                                 "Of the intensity, J s/m^2; 0: none");
      healing_ = laws::read_healing(reader);
      const PowerSeries f =
          read_function(reader, "stiffness function", "beta^2",
                        "Of the intensity beta: 0 at 0, 1 at 1, rising", false);
      const PowerSeries g =
          read_function(reader, "surface energy function", "1 - beta",
                        "Of the intensity beta: 1 at 0, 0 at 1, falling", true);
      curve_ = {stiffness_, energy_, f, g};
      peak_intensity_ = curve_.peak_intensity();
      peak_ = curve_.opening_at(peak_intensity_);
      steepest_ = curve_.steepest_softening();
      if (viscosity_ > 0. && curve_.jumps())
        reader.error("damage viscosity",
                     "the intensity of these functions jumps at a constant "
                     "opening, which a viscosity cannot follow here",
                     "remove it, or take functions with a gradual softening");
    }

    bool extrinsic() const override { return false; }
    double normal_stiffness() const override { return stiffness_; }
    double stiffness_ratio() const override { return stiffness_ratio_; }
    double shear_weight() const override { return stiffness_ratio_; }

    double beta(const double d) const override
    {
      return d <= elastic_limit() ? 1.
                                  : curve_.stiffness_at(curve_.intensity(d));
    }
    double traction(const double d) const override
    {
      return beta(d) * stiffness_ * d;
    }
    double energy(const double d) const override
    {
      if (d <= elastic_limit())
        return 0.5 * stiffness_ * d * d;
      const double b = curve_.intensity(d);
      // 0 x infinity far out in a tail
      const double stored =
          b > 0. ? 0.5 * curve_.stiffness_at(b) * stiffness_ * d * d : 0.;
      return stored + curve_.spent(b);
    }

    double elastic_limit() const override { return curve_.elastic_limit(); }
    double peak_opening() const override { return peak_; }
    double final_opening() const override { return curve_.final_opening(); }
    double strength() const override
    {
      return curve_.traction_at(peak_intensity_);
    }
    double toughness() const override { return energy_; }
    double steepest_softening() const override { return steepest_; }

    bool rate_dependent() const override { return viscosity_ > 0.; }

    bool heals() const override { return healing_.time > 0.; }

    double healed_opening(const double d_m, const double pressure,
                          const double time) const override
    {
      if (!heals() || d_m <= elastic_limit())
        return d_m;
      const double before = std::isinf(d_m) ? 0. : curve_.intensity(d_m),
                   b = curve_.healed(before, healing_.rate(pressure) * time);
      return b > before ? std::min(d_m, curve_.opening_at(b)) : d_m;
    }

    /**
     * With d held, y = ln(b - b_end) goes at the smooth rate chi / (eta (b -
     * b_end)): the time is integrated over y until it is used up.
     */
    double delayed_opening(const double d_m, const double d,
                           const double time) const override
    {
      if (!rate_dependent() || d <= d_m)
        return std::max(d_m, d);
      const double end = curve_.intensity(d),
                   start = curve_.intensity(d_m) - end;
      const auto slowness = [&](const double y) {
        const double b = end + std::exp(y);
        return viscosity_ * std::exp(y) / curve_.driving_force(b, d);
      };
      if (!(start > 0.))
        return d;
      const double step = 0.5;
      double y = std::log(start), left = time;
      for (unsigned int k = 0; k < 80; ++k, y -= step) {
        const double needed = integrate(slowness, y - step, y);
        if (!(needed < left)) {
          const auto excess = [&](const double x) {
            return left - integrate(slowness, y - x, y);
          };
          y -= bracketed_root(excess, 0., step, left, left - needed);
          return std::clamp(std::sqrt(curve_.square_at(end + std::exp(y))), d_m,
                            d);
        }
        left -= needed;
      }
      return d;
    }

  private:
    double stiffness_, energy_, stiffness_ratio_, viscosity_;
    laws::Healing healing_;
    AdhesionCurve curve_;
    double peak_ = 0., peak_intensity_ = 1., steepest_ = 0.;
  };

  NSFD_REGISTER(CohesiveLawRegistry, Fremond, "fremond",
                "Intrinsic, free energy and pseudo-potential (7)-(11) by "
                "formulas; from stiffness and adhesion energy",
                "stiffness = 2e12; adhesion energy = 8 J/m^2",
                "stiffness = 2e12; adhesion energy = 8 J/m^2; "
                "tangential stiffness = 5e12; stiffness function = beta^1.5",
                "stiffness = 2e12; adhesion energy = 8 J/m^2; "
                "stiffness function = beta; damage viscosity = 0",
                "stiffness = 2e12; adhesion energy = 8 J/m^2; "
                "damage viscosity = 0.01",
                "stiffness = 2e12; adhesion energy = 8 J/m^2; "
                "healing time = 1 ms");
} // namespace nsfd
