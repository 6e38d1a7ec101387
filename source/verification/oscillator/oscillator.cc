#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <complex>

namespace nsfd
{
  using namespace cases;

  /**
   * A bar of one linear cell held at its left end: one degree of freedom,
   * omega = sqrt(3 E / rho) / L, or sqrt(2 E / rho) / L with lumped mass, from
   * rest. The theta scheme multiplies q + i v / omega, seen along its own
   * ellipse, in each step z = omega h by
   *
   *   (1 + i (1 - theta) z) / (1 - i theta z).
   */
  class Oscillator final : public VerificationCase
  {
  public:
    explicit Oscillator(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      const Bar bar = bar_of(input);
      for (unsigned int d = 0; d < input.dimension; ++d)
        demand(n_cells(input, d) == 1., "the bar must be one cell");
      demand(input.discretization.degree == 1,
             "the bar must have degree 1: one degree of freedom");
      frequency_ = std::sqrt(input.discretization.lumped_mass ? 2. : 3.) *
                   bar.speed / extent(input, 0);
      theta_ = input.time.theta;
      known_ = input.time.scheme.theta_scheme;
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      const double q = mean(*view.cells, &CellState::displacement, 0),
                   v = mean(*view.cells, &CellState::velocity, 0);
      place_ = {q, -v / frequency_};
      const double energy = mechanical_energy(*view.row);
      if (view.row->step == 0) {
        start_ = place_;
        initial_energy_ = energy;
      } else {
        const double z = frequency_ * view.time_step;
        const std::complex<double> factor =
            std::complex<double>(1., (1. - theta_) * z) /
            std::complex<double>(1., -theta_ * z);
        scheme_ *= std::abs(factor);
        angle_ += std::arg(factor);
      }
      energy_ = std::max(energy_, std::abs(energy - initial_energy_));
      time_ = view.time;
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      const double amplitude = std::abs(start_);
      errors["position"] =
          std::abs(place_.real() - amplitude * std::cos(frequency_ * time_)) /
          amplitude;
      errors["energy"] = energy_ / initial_energy_;
      if (!known_)
        return;
      errors["amplification"] =
          relative_error(std::abs(place_) / amplitude, scheme_);
      // on the circle: a turn more or less is none
      errors["phase"] =
          std::abs(place_ / std::abs(place_) - std::polar(1., angle_)) / angle_;
    }

    void serialize(Archive &archive) override
    {
      double start[2] = {start_.real(), start_.imag()},
             place[2] = {place_.real(), place_.imag()};
      archive.numbers("found", time_, energy_, initial_energy_, scheme_, angle_,
                      start[0], start[1], place[0], place[1]);
      start_ = {start[0], start[1]};
      place_ = {place[0], place[1]};
    }

  private:
    double frequency_ = 0., theta_ = 0.5, time_ = 0., energy_ = 0.,
           initial_energy_ = 0.;
    bool known_ = true;
    std::complex<double> start_, place_;
    double scheme_ = 1., angle_ = 0.;
  };

  NSFD_REGISTER(VerificationRegistry, Oscillator, "oscillator",
                "A bar of one cell: amplification and phase of the theta "
                "scheme, error of the position");
} // namespace nsfd
