#include "verification/spring_and_floor.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * A mass on a spring and a floor with friction starts from rest at x_0. With
   * delta = mu m g / k every half cycle pi/omega brings it 2 delta nearer; it
   * stays where the spring is weaker than friction, after the n-th half cycle
   * at (-1)^n (x_0 - 2 n delta). Friction has then taken what the spring has
   * lost.
   */
  class DryOscillator final : public VerificationCase
  {
  public:
    explicit DryOscillator(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      const SpringAndFloor scene(input);
      delta_ = scene.held_length();
      const double x = input.mesh.upper[0], y = input.mesh.lower[1];
      start_ =
          material_at(input, {{x, y, 0.}}).initial_displacement[0](x, y, 0.);
      demand(std::abs(start_) > delta_, "friction holds the block from start");
      const double n = std::ceil(0.5 * (std::abs(start_) / delta_ - 1.));
      half_cycles_ = n;
      rest_ = (std::fmod(n, 2.) == 0. ? 1. : -1.) *
              std::copysign(std::abs(start_) - 2. * n * delta_, start_);
      stop_time_ = n * std::acos(-1.) / scene.frequency();
      demand(input.time.end > stop_time_,
             "the run ends before the block stops");
      work_ = 0.5 * scene.stiffness * (start_ * start_ - rest_ * rest_);
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      const CellState &block = block_of(view);
      const double v = block.velocity[0];
      position_ = block.displacement[0];
      friction_ = view.row->energy.friction;
      fastest_ = std::max(fastest_, std::abs(v));
      // still from this step on; a turning point is no rest
      if (std::abs(v) > 1e-9 * fastest_) {
        // friction that holds the mass where it turns leaves it the speed of
        // the step before for one step (mean velocity zero): not a half cycle
        const double direction = v > 0. ? 1. : -1.;
        turns_ += direction * direction_ < 0. && direction == last_direction_;
        if (direction == last_direction_)
          direction_ = direction;
        last_direction_ = direction;
        moving_until_ = view.time;
        creep_ = 0.;
      } else
        creep_ = std::max(creep_, std::abs(v));
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      errors["half_cycles"] = turns_ + 1.;
      errors["rest_position"] = std::abs(position_ - rest_) / delta_;
      errors["rest_over_delta"] = std::abs(rest_) / delta_;
      errors["exact_half_cycles"] = half_cycles_;
      errors["stop_time"] = relative_error(moving_until_, stop_time_);
      errors["friction_work"] = relative_error(friction_, work_);
      errors["velocity_after_stop"] = creep_ / fastest_;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", position_, friction_, fastest_, direction_,
                      last_direction_, turns_, moving_until_, creep_);
    }

  private:
    double delta_ = 0., start_ = 0., rest_ = 0., half_cycles_ = 0.,
           stop_time_ = 0., work_ = 0.;
    double position_ = 0., friction_ = 0., fastest_ = 0., direction_ = 0.,
           last_direction_ = 0., turns_ = 0., moving_until_ = 0., creep_ = 0.;
  };

  NSFD_REGISTER(VerificationRegistry, DryOscillator, "dry oscillator",
                "Mass on a spring, stopped by friction: half cycles, place, "
                "time, work");
} // namespace nsfd
