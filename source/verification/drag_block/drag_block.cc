#include "verification/spring_and_floor.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * A block at rest on a floor with friction is dragged through a spring whose
   * other end moves at V. It starts at t_0 = mu m g / (k V) and then moves with
   *
   *   v = V (1 - cos(omega (t - t_0))),    V 2 pi / omega in each cycle.
   *
   * At the end of each cycle v touches 0 without a time of rest.
   */
  class DragBlock final : public VerificationCase
  {
  public:
    explicit DragBlock(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      const SpringAndFloor scene(input);
      for (const BoundaryInput &boundary : input.boundaries)
        if (boundary.velocity[0] && boundary.velocity[0]->is_constant())
          speed_ = (*boundary.velocity[0])(0., 0., 0.);
      demand(speed_ > 0., "a boundary must move with a constant velocity x");
      omega_ = scene.frequency();
      start_ = scene.held_length() / speed_;
      demand(input.time.end > start_ + period(),
             "the run ends before the first cycle does");
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      const double t = view.time, h = view.time_step;
      const double v = block_of(view).velocity[0],
                   u = block_of(view).displacement[0];
      const bool rests = std::abs(v) <= 1e-9 * speed_;
      if (!rests && measured_start_ == 0.)
        measured_start_ = t - h;
      stick_ = rests && measured_start_ > 0. ? stick_ + 1. : 0.;
      longest_stick_ = std::max(longest_stick_, stick_);
      const double s = positive_part(t - start_);
      const double end = start_ + period();
      if (t <= end * (1. + 1e-12))
        velocity_ = std::max(
            velocity_, std::abs(v - speed_ * (1. - std::cos(omega_ * s))));
      // between the two steps around the end of the first cycle
      if (t - h < end && t >= end)
        after_cycle_ = u + (old_ - u) * (t - end) / h;
      old_ = u;
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      errors["start_time"] = relative_error(measured_start_, start_);
      errors["velocity"] = velocity_ / speed_;
      errors["displacement"] = relative_error(after_cycle_, speed_ * period());
      errors["exact_displacement"] = speed_ * period();
      errors["longest_stick_in_steps"] = longest_stick_;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", measured_start_, velocity_, after_cycle_, old_,
                      stick_, longest_stick_);
    }

  private:
    double speed_ = 0., omega_ = 0., start_ = 0.;
    double measured_start_ = 0., velocity_ = 0., after_cycle_ = 0., old_ = 0.,
           stick_ = 0., longest_stick_ = 0.;

    double period() const { return 2. * std::acos(-1.) / omega_; }
  };

  NSFD_REGISTER(VerificationRegistry, DragBlock, "drag block",
                "Block dragged through a spring against friction: start, "
                "velocity, no stick between cycles");
} // namespace nsfd
