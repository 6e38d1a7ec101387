#include "nsfd/verification/case_input.h"
#include "verification/line_fit.h"

#include "nsfd/core/archive.h"
#include "nsfd/parameters/section_reader.h"
#include "nsfd/postprocess/running_crack.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * A crack along the middle of a long strip between held faces, stretched
   * uniformly across: every unit of length ahead of the tip holds the energy
   * G = (lambda + 2 mu) u_0^2 / h, which a steady crack of any speed releases,
   * whatever the shape of the cohesive law. With G above the toughness the
   * speed rises towards that of Rayleigh waves and stays below it (Freund,
   * Dynamic Fracture Mechanics, 1990, sections 5.4 and 7.4).
   *
   * With observables `tip` (energy release rate) and `crack` their means over
   * the steady part are compared with the toughness, which the cohesive zone
   * takes at any speed, and with the energy G ahead of the tip.
   */
  class StripCrack final : public VerificationCase
  {
  public:
    explicit StripCrack(SectionReader &reader)
    {
      start_ = reader.number("steady from", "", units::time, Range::positive(),
                             "time from which on the speed is measured");
    }

    void initialise(const SceneInput &input) override
    {
      const MaterialInput &material = input.materials.front();
      demand(!material.rigid && !input.plane_stress,
             "the strip is elastic and in plane strain");
      rayleigh_ = RunningCrack(material, false).rayleigh_speed();
      toughness_ = cohesive_interface(input).law->toughness();
      const double nu = material.poisson, half = extent(input, 1) / 2.,
                   u = material.initial_displacement[1](0., half, 0.);
      available_ = material.young * (1. - nu) / ((1. + nu) * (1. - 2. * nu)) *
                   u * u / half;
      for (const ObservableInput &block : input.observables)
        watched_ = watched_ || block.name == "tip";
    }

    void observe(const StepView &view) override
    {
      const double t = view.time, a = view.row->broken_area;
      if (t < start_)
        return;
      fit_.add(t, a);
      if (!watched_)
        return;
      const double h = view.time_step;
      time_ += h;
      release_ += h * view.observed("tip", "G");
      zone_ += h * view.observed("tip", "zone");
      spread_ += h * view.observed("tip", "spread");
      spent_ += h * view.observed("crack", "energy_per_length");
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      if (const auto slope = fit_.slope())
        errors["speed_over_rayleigh"] = *slope / rayleigh_;
      if (!(time_ > 0.))
        return;
      errors["G_over_toughness"] = release_ / time_ / toughness_;
      errors["G_over_available"] = release_ / time_ / available_;
      errors["zone_over_toughness"] = zone_ / time_ / toughness_;
      errors["spent_over_toughness"] = spent_ / time_ / toughness_;
      errors["contours"] = spread_ / time_;
    }

    void serialize(Archive &archive) override
    {
      fit_.serialize(archive);
      archive.numbers("means", time_, release_, zone_, spread_, spent_);
    }

  private:
    double start_ = 0., rayleigh_ = 0., toughness_ = 0.,
           available_ = 0.; // per length ahead of the tip
    bool watched_ = false;
    LineFit fit_; // crack length over time
    // over the steady part
    double time_ = 0., release_ = 0., zone_ = 0., spread_ = 0., spent_ = 0.;
  };

  NSFD_REGISTER(VerificationRegistry, StripCrack, "strip crack",
                "Steady crack in a stretched strip: speed over Rayleigh speed");
} // namespace nsfd
