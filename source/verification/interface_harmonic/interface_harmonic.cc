#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <vector>

namespace nsfd
{
  using namespace cases;

  namespace
  {
    /** Amplitude and lag of samples of sin(phase - lag), by least squares. */
    struct Wave {
      double ss = 0., sc = 0., cc = 0., s = 0., c = 0.;

      void add(const double phase, const double value)
      {
        const double sine = std::sin(phase), cosine = std::cos(phase);
        ss += sine * sine;
        sc += sine * cosine;
        cc += cosine * cosine;
        s += sine * value;
        c += cosine * value;
      }
      double of_sine() const { return (s * cc - c * sc) / (ss * cc - sc * sc); }
      double of_cosine() const
      {
        return (c * ss - s * sc) / (ss * cc - sc * sc);
      }
      double amplitude() const { return std::hypot(of_sine(), of_cosine()); }
      double lag() const { return std::atan2(-of_cosine(), of_sine()); }
    };
  } // namespace

  /**
   * A harmonic wave sigma_0 sin(omega t) from the left end of a bar meets an
   * elastic interface K at its middle. With Z = rho c and a = 2 K / Z the jump
   * is, s after the wave arrives,
   *
   *   delta = 2 sigma_0 / Z / (a^2 + omega^2)
   *           (a sin(omega s) - omega cos(omega s) + omega exp(-a s)),
   *
   * so that |T| = 1 / sqrt(1 + (omega Z / 2 K)^2), |R| = (omega Z / 2 K) |T|,
   * and T lags by atan(omega Z / 2 K). Until the reflected wave is back at the
   * left end and the transmitted one at the right end.
   */
  class InterfaceHarmonic final : public VerificationCase
  {
  public:
    explicit InterfaceHarmonic(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      const Bar bar = bar_of(input);
      const LoadedSide side = loaded_side(input);
      demand(side.normal.axis == 0 && side.normal.sign < 0.,
             "the wave must enter on the left side");
      start_ = input.mesh.lower[0];
      half_ = 0.5 * extent(input, 0);
      speed_ = bar.speed;
      impedance_ = bar.impedance();
      rate_ = 2. * elastic_interface(input).normal_stiffness / impedance_;
      demand(input.time.end <= 2. * half_ / speed_,
             "the run must end before the waves are at the ends of the bar");
      // the load is sigma_0 sin(omega t): both from two of its values
      const double d = input.time.end / 1000.;
      const double once = side.tension(d), twice = side.tension(2. * d);
      const double cosine = twice / (2. * once);
      demand(once != 0. && std::abs(cosine) < 1.,
             "the load must be sigma_0 sin(omega t)");
      frequency_ = std::acos(cosine) / d;
      stress_ = once / std::sin(frequency_ * d);
    }

    bool has_fields() const override { return true; }

    Vector displacement(const Vector &x, const double t) const override
    {
      const double X = x[0] - start_;
      if (X > half_)
        return {transmitted_travel(t - X / speed_), 0., 0.};
      const double back = t - (2. * half_ - X) / speed_;
      return {incident_travel(t - X / speed_) + incident_travel(back) -
                  transmitted_travel(back),
              0., 0.};
    }

    Vector velocity(const Vector &x, const double t) const override
    {
      const double X = x[0] - start_;
      if (X > half_)
        return {-transmitted(t - X / speed_) / impedance_, 0., 0.};
      const double back = t - (2. * half_ - X) / speed_;
      return {(-incident(t - X / speed_) - incident(back) + transmitted(back)) /
                  impedance_,
              0., 0.};
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      time_ = view.time;
      cells_ = *view.cells;
    }

    /**
     * Over one wave length on either side of the interface, against the wave
     * that comes in there: cells average all of them alike.
     */
    void finish(std::map<std::string, double> &errors) const override
    {
      const double length = 2. * std::acos(-1.) * speed_ / frequency_;
      Wave in, out, through;
      unsigned int count = 0;
      for (const CellState &cell : cells_) {
        const double X = cell.centre[0] - start_;
        const double go = frequency_ * (time_ - X / speed_),
                     back = frequency_ * (time_ - (2. * half_ - X) / speed_);
        const double momentum = impedance_ * cell.velocity[0];
        if (X > half_ && X < half_ + length)
          through.add(go, cell.stress[0]);
        else if (X < half_ && X > half_ - length) {
          in.add(go, (cell.stress[0] - momentum) / 2.);
          out.add(back, (cell.stress[0] + momentum) / 2.);
          ++count;
        }
      }
      demand(count >= 8, "the mesh is too coarse for the wave");
      const double ratio = frequency_ / rate_;
      const double exact = 1. / std::sqrt(1. + ratio * ratio);
      const double t = through.amplitude() / in.amplitude(),
                   r = out.amplitude() / in.amplitude();
      errors["transmission"] = relative_error(t, exact);
      errors["reflection"] = relative_error(r, ratio * exact);
      errors["phase_lag"] =
          relative_error(through.lag() - in.lag(), std::atan(ratio));
      errors["power"] = std::abs(t * t + r * r - 1.);
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", time_);
      constexpr std::size_t n = sizeof(CellState) / sizeof(double);
      std::vector<double> values(n * cells_.size());
      std::memcpy(values.data(), cells_.data(), values.size() * sizeof(double));
      archive.common("cells", values);
      cells_.resize(values.size() / n);
      std::memcpy(cells_.data(), values.data(), values.size() * sizeof(double));
    }

  private:
    double start_ = 0., half_ = 0., speed_ = 0., impedance_ = 0., rate_ = 0.,
           frequency_ = 0., stress_ = 0., time_ = 0.;
    std::vector<CellState> cells_;

    double incident(const double s) const
    {
      return s > 0. ? stress_ * std::sin(frequency_ * s) : 0.;
    }

    /** Its displacement: -1/Z of the integral. */
    double incident_travel(const double s) const
    {
      return s > 0. ? -stress_ * (1. - std::cos(frequency_ * s)) /
                          (frequency_ * impedance_)
                    : 0.;
    }

    double share() const
    {
      return stress_ * rate_ / (rate_ * rate_ + frequency_ * frequency_);
    }

    double transmitted(const double s) const
    {
      const double a = rate_, w = frequency_;
      return s > 0. ? share() * (a * std::sin(w * s) - w * std::cos(w * s) +
                                 w * std::exp(-a * s))
                    : 0.;
    }

    double transmitted_travel(const double s) const
    {
      const double a = rate_, w = frequency_;
      return s > 0. ? -share() / impedance_ *
                          (a / w * (1. - std::cos(w * s)) - std::sin(w * s) -
                           w / a * std::expm1(-a * s))
                    : 0.;
    }
  };

  NSFD_REGISTER(VerificationRegistry, InterfaceHarmonic, "interface harmonic",
                "A harmonic wave on an elastic interface: transmission, "
                "reflection, phase, fields");
} // namespace nsfd
