#include "case_input.h"
#include "line_fit.h"

#include "nsfd/base/archive.h"
#include "nsfd/input/section_reader.h"

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
      rayleigh_ = rayleigh_speed(material);
    }

    void observe(const StepView &view) override
    {
      const double t = view.time, a = view.row->broken_area;
      if (t < start_)
        return;
      fit_.add(t, a);
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      if (const auto slope = fit_.slope())
        errors["speed_over_rayleigh"] = *slope / rayleigh_;
    }

    void remember(Archive &archive) override
    {
      fit_.remember(archive);
    }

  private:
    double start_ = 0., rayleigh_ = 0.;
    LineFit fit_; // crack length over time

    /** Root of 4 a_d a_s = (1 + a_s^2)^2 below the shear speed. */
    static double rayleigh_speed(const MaterialInput &material)
    {
      const double nu = material.poisson,
                   shear = std::sqrt(material.young / (2. * (1. + nu)) /
                                     material.density),
                   ratio = (1. - 2. * nu) / (2. * (1. - nu)); // (c_s/c_d)^2
      double low = 0.5, high = 1.;
      for (unsigned int k = 0; k < 60; ++k) {
        const double x = 0.5 * (low + high), s = 1. - x * x,
                     d = 1. - ratio * x * x;
        (4. * std::sqrt(d * s) > (1. + s) * (1. + s) ? low : high) = x;
      }
      return low * shear;
    }
  };

  NSFD_REGISTER(VerificationRegistry, StripCrack, "strip crack",
                "Steady crack in a stretched strip: speed over Rayleigh speed");
} // namespace nsfd
