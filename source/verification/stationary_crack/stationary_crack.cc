#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"
#include "nsfd/parameters/section_reader.h"
#include "nsfd/postprocess/running_crack.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * A long crack that stands still is met by a step of tension s that comes
   * from one side, H above it. Until waves return from the sides of the plate,
   * three times their way H/c_d,
   *
   *   K = 2 s/(1 - nu) sqrt(c_d (t - H/c_d) (1 - 2 nu)/pi),   0 before
   *
   * (Freund, Dynamic Fracture Mechanics, 1990, section 2.4). K is that of
   * `Observable: NAME`, of type energy release rate, which holds where a step
   * is in balance.
   */
  class StationaryCrack final : public VerificationCase
  {
  public:
    explicit StationaryCrack(SectionReader &reader)
        : name_(reader.word("observable", "tip", "of type energy release rate"))
    {
      distance_ =
          reader.number("distance", "", units::length, Range::positive(),
                        "from the load to the crack");
      tension_ = reader.number("tension", "", units::pressure,
                               Range::positive(), "of the step");
    }

    void initialise(const SceneInput &input) override
    {
      const MaterialInput &material = input.materials.front();
      demand(input.dimension == 2 && !input.plane_stress && !material.rigid,
             "the plate is elastic and in plane strain");
      speed_ = RunningCrack(material, false).pressure_speed();
      poisson_ = material.poisson;
      theta_ = input.time.theta;
    }

    void observe(const StepView &view) override
    {
      if (view.time_step == 0.)
        return;
      const double K = view.observed(name_, "K"),
                   t = view.time - (1. - theta_) * view.time_step,
                   arrival = distance_ / speed_;
      if (t > 3. * arrival)
        return;
      const double end = exact(3. * arrival), known = exact(t);
      sum_ += view.time_step * std::abs(K - known);
      exact_sum_ += view.time_step * known;
      if (t < 0.9 * arrival)
        early_ = std::max(early_, K / end);
      if (t > 1.5 * arrival)
        largest_ = std::max(largest_, std::abs(K - known) / end);
      spread_ = t > 1.5 * arrival
                    ? std::max(spread_, view.observed(name_, "spread"))
                    : 0.;
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      errors["K_L1"] = sum_ / exact_sum_;
      errors["K_largest"] = largest_;
      errors["K_before"] = early_;
      errors["contours"] = spread_;
      errors["exact_K_2"] = exact(2. * distance_ / speed_);
      errors["exact_K_3"] = exact(3. * distance_ / speed_);
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", sum_, exact_sum_, early_, largest_, spread_);
    }

  private:
    double exact(const double t) const
    {
      const double since = std::max(0., t - distance_ / speed_);
      return 2. * tension_ / (1. - poisson_) *
             std::sqrt(speed_ * since * (1. - 2. * poisson_) / std::acos(-1.));
    }

    const std::string name_;
    double distance_ = 0., tension_ = 0., speed_ = 0., poisson_ = 0.,
           theta_ = 0.5;
    double sum_ = 0., exact_sum_ = 0., early_ = 0., largest_ = 0., spread_ = 0.;
  };

  NSFD_REGISTER(VerificationRegistry, StationaryCrack, "stationary crack",
                "Step load on a long crack: stress intensity factor over time",
                "distance = 2 m; tension = 500 MPa");
} // namespace nsfd
