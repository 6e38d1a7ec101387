#include "nsfd/verification/case_input.h"
#include "verification/line_fit.h"

#include "nsfd/core/archive.h"
#include "nsfd/parameters/section_reader.h"

#include <limits>

namespace nsfd
{
  using namespace cases;

  /**
   * A crack that runs and stops in a stretched strip: the string model of
   * Freund (Dynamic Fracture Mechanics, 1990, section 7.4), here with a bar
   * pulled along x between rigid bases. The strip is free up to l_0 and bonded
   * beyond, its end x = 0 is held so that the energy release rate at rest is
   * n times the toughness, n > 1. Then, with the wave speed c of the bar,
   *
   *   v = c (n - 1) / (n + 1)         up to t = 2 l_0 / (c - v),
   *
   * when the wave that the held end reflects catches the tip: the crack stops
   * at n l_0, the whole strip is at rest, and the work of fracture is what the
   * elastic energy has lost. Exact for a process length small against l_0.
   */
  class PeeledStrip final : public VerificationCase
  {
  public:
    explicit PeeledStrip(SectionReader &reader)
    {
      length_ = reader.number("crack length", "", units::length,
                              Range::positive(), "l_0, free at t = 0");
      overload_ = reader.number(
          "overload", "", units::none,
          {1., std::numeric_limits<double>::infinity(), true, false},
          "n, energy release rate over toughness");
      planes_ = reader.integer("crack planes", "1", 1, 2,
                               "that the strip is bonded on");
    }

    void initialise(const SceneInput &input) override
    {
      const MaterialInput *strip = nullptr;
      for (const MaterialInput &material : input.materials)
        if (!material.rigid)
          strip = &material;
      demand(strip != nullptr && strip->poisson == 0.,
             "the strip needs an elastic material with `Poisson ratio = 0`");
      const double c = std::sqrt(strip->young / strip->density);
      speed_ = c * (overload_ - 1.) / (overload_ + 1.);
      arrest_time_ = 2. * length_ / (c - speed_);
      toughness_ = cohesive_interface(input).law->toughness();
    }

    void observe(const StepView &view) override
    {
      const EnergyLines &energy = view.row->energy;
      if (view.row->step == 0)
        initial_energy_ = energy.elastic + energy.cohesive;
      growth_ = view.row->broken_area / planes_;
      damage_ = energy.damage;
      const double t = view.time;
      if (t <= arrest_time_)
        kinetic_ = energy.kinetic;
      // away from start and arrest, which take a process length
      if (t >= 0.2 * arrest_time_ && t <= 0.8 * arrest_time_) {
        fit_.add(t, growth_);
      }
      path_error_ += view.time_step * std::abs(growth_ - exact_growth(t));
      path_ += view.time_step * exact_growth(t);
      time_ = t;
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      if (const auto slope = fit_.slope())
        errors["crack_speed"] = relative_error(*slope, speed_);
      if (path_ > 0.)
        errors["tip_path"] = path_error_ / path_; // L1 in time
      if (time_ > arrest_time_) {
        errors["arrest_length"] =
            relative_error(length_ + growth_, overload_ * length_);
        errors["kinetic"] = kinetic_ / initial_energy_;
        errors["damage"] = relative_error(
            damage_, planes_ * toughness_ * (overload_ - 1.) * length_);
      }
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", growth_, damage_, kinetic_, initial_energy_,
                      time_, path_error_, path_);
      fit_.serialize(archive);
    }

  private:
    double exact_growth(const double t) const
    {
      return speed_ * std::min(t, arrest_time_);
    }

    double length_ = 0., overload_ = 0., toughness_ = 0.;
    unsigned int planes_ = 1;
    double speed_ = 0., arrest_time_ = 0.;
    double growth_ = 0., damage_ = 0., kinetic_ = 0., initial_energy_ = 0.,
           time_ = 0., path_error_ = 0., path_ = 0.;
    LineFit fit_; // crack length over time
  };

  NSFD_REGISTER(VerificationRegistry, PeeledStrip, "peeled strip",
                "Crack that runs and stops: speed, length, energies");
} // namespace nsfd
