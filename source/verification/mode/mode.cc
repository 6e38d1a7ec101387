#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Standing mode of a bar with fixed ends and an elastic interface K at its
   * middle, both halves of length a moving against each other:
   *
   *   u = A sin(omega x / c) cos(omega t),  x from the lower end, x < a,
   *   u = -A sin(omega (2a - x) / c) cos(omega t)  beyond,
   *   tan(omega a / c) = -omega E / (2 K c),   root in (pi/2, pi) c/a.
   *
   * There is no front: the full order in space and time shows. A is what the
   * initial displacement is at x = a/2. (It jumps at the interface, where a
   * node belongs to both halves: give each half a material of its own.)
   */
  class Mode final : public VerificationCase
  {
  public:
    explicit Mode(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      const Bar bar = bar_of(input);
      // the longest direction of the box is the bar's
      for (unsigned int d = 1; d < input.dimension; ++d)
        if (extent(input, d) > extent(input, axis_))
          axis_ = d;
      start_ = input.mesh.lower[axis_];
      half_ = 0.5 * extent(input, axis_);
      const double stiffness =
          elastic_interface(input).normal_stiffness * half_ / bar.young;
      wave_number_ = root(stiffness) / half_;
      frequency_ = wave_number_ * bar.speed;

      std::array<double, 3> x{};
      for (unsigned int d = 0; d < input.dimension; ++d)
        x[d] = 0.5 * (input.mesh.lower[d] + input.mesh.upper[d]);
      x[axis_] = start_ + 0.5 * half_;
      amplitude_ =
          material_at(input, x).initial_displacement[axis_](x[0], x[1], x[2]) /
          std::sin(0.5 * wave_number_ * half_);
      demand(amplitude_ != 0., "the initial displacement must be the mode");
    }

    bool has_fields() const override { return true; }

    Vector displacement(const Vector &x, const double t) const override
    {
      return shape(x, std::cos(frequency_ * t));
    }

    bool has_jump() const override { return true; }

    Vector jump(const Vector &x, const Vector &n, const double t) const override
    {
      Vector jump{};
      if (std::abs(x[axis_] - start_ - half_) < 1e-9 * half_)
        jump[axis_] = -2. * amplitude_ * std::cos(frequency_ * t) *
                      std::sin(wave_number_ * half_) *
                      (n[axis_] > 0. ? 1. : -1.);
      return jump;
    }

    Vector velocity(const Vector &x, const double t) const override
    {
      return shape(x, -frequency_ * std::sin(frequency_ * t));
    }

    void observe(const StepView &view) override
    {
      time_ = view.time;
      energy_ = mechanical_energy(*view.row);
      kinetic_ = view.row->energy.kinetic;
      if (view.row->step == 0)
        initial_energy_ = energy_;
      drift_ = std::max(drift_, relative_error(energy_, initial_energy_));
    }

    /** The kinetic share of the energy, sin^2(omega t), tells the frequency. */
    void finish(std::map<std::string, double> &errors) const override
    {
      errors["energy"] = drift_;
      const double cosine =
          std::min(1., std::max(-1., 1. - 2. * kinetic_ / energy_));
      const double angle = std::acos(cosine), exact = 2. * frequency_ * time_;
      const double turn = 2. * std::acos(-1.);
      const double turns = turn * std::round(exact / turn);
      const double phase =
          turns + (exact < turns ? -angle : angle); // 2 omega t as measured
      errors["frequency"] = relative_error(phase, exact);
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", time_, energy_, initial_energy_, kinetic_,
                      drift_);
    }

  private:
    unsigned int axis_ = 0;
    double start_ = 0., half_ = 0., wave_number_ = 0., frequency_ = 0.,
           amplitude_ = 0.;
    double time_ = 0., energy_ = 0., initial_energy_ = 0., kinetic_ = 0.,
           drift_ = 0.;

    /** z in (pi/2, pi) with tan z = -z / (2 K a / E), by bisection. */
    static double root(const double stiffness)
    {
      double low = 0.5 * std::acos(-1.), high = std::acos(-1.);
      for (unsigned int i = 0; i < 100; ++i) {
        const double z = 0.5 * (low + high);
        const double value = std::sin(z) + z / (2. * stiffness) * std::cos(z);
        (value > 0. ? low : high) = z;
      }
      return 0.5 * (low + high);
    }

    Vector shape(const Vector &x, const double factor) const
    {
      const double position = x[axis_] - start_;
      const double value =
          position < half_ ? std::sin(wave_number_ * position)
                           : -std::sin(wave_number_ * (2. * half_ - position));
      Vector result{};
      result[axis_] = amplitude_ * factor * value;
      return result;
    }
  };

  NSFD_REGISTER(VerificationRegistry, Mode, "mode",
                "Standing mode of a bar with an elastic interface: fields, "
                "frequency");
} // namespace nsfd
