#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Ball that falls on a floor and bounces with restitution e: flights of the
   * duration 2 v_n / g, v_n = e^n v_1, between impacts. For e < 1 they end at
   * the accumulation time t_1 + 2 v_1 e / (g (1 - e)); the ball rests from
   * then on. All cells fall alike: the height is that of the whole body.
   */
  class Ball final : public VerificationCase
  {
  public:
    explicit Ball(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      demand_box(input);
      demand(input.obstacles.size() == 1, "the case needs one Obstacle");
      const ObstacleInput &floor = input.obstacles[0];
      up_ = direction_of(floor.normal);
      const unsigned int d = up_.axis;
      const double bottom =
          (up_.sign > 0. ? input.mesh.lower : input.mesh.upper)[d];
      height_ = up_.sign * (bottom - floor.point[d]);
      gravity_ = -up_.sign * input.gravity[d];
      restitution_ = floor.restitution;
      const auto &lower = input.mesh.lower;
      start_ = up_.sign *
               input.materials[0].initial_velocity[d](
                   lower[0], lower[1], input.dimension == 3 ? lower[2] : 0.);
      demand(gravity_ > 0., "gravity must pull towards the floor");
      demand(height_ >= 0., "the ball must start above the floor");
      impact_speed_ = std::sqrt(start_ * start_ + 2. * gravity_ * height_);
      demand(impact_speed_ > 0., "the ball must fall or move");
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      const double height =
          height_ +
          up_.sign * mean(*view.cells, &CellState::displacement, up_.axis);
      velocity_ = mean(*view.cells, &CellState::velocity, up_.axis);
      const double exact = exact_height(view.time);
      difference_ += std::abs(height - exact);
      reference_ += std::abs(exact);
      deepest_ = std::max(deepest_, -height);
      step_ = std::max(step_, view.time_step);
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      errors["displacement_eta"] = difference_ / reference_;
      errors["rest"] = std::abs(velocity_) / impact_speed_;
      // The forecast sees the floor within the last half of a step; the step of
      // the impact then goes on with the mean of the speeds before and after.
      const double bound = 0.5 * (2. - restitution_) * step_ *
                           (impact_speed_ + gravity_ * step_);
      errors["penetration"] = deepest_ / bound;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", difference_, reference_, velocity_, deepest_,
                      step_);
    }

  private:
    Direction up_;
    double height_ = 0., start_ = 0., gravity_ = 0., restitution_ = 0.,
           impact_speed_ = 0.;
    double difference_ = 0., reference_ = 0., velocity_ = 0., deepest_ = 0.,
           step_ = 0.;

    double exact_height(const double t) const
    {
      double s = t - (start_ + impact_speed_) / gravity_;
      if (s < 0.)
        return height_ + (start_ - 0.5 * gravity_ * t) * t;
      double v = restitution_ * impact_speed_;
      // a flight lower than round-off is rest
      while (v > 1e-9 * impact_speed_ && s > 2. * v / gravity_) {
        s -= 2. * v / gravity_;
        v *= restitution_;
      }
      return v > 1e-9 * impact_speed_ ? (v - 0.5 * gravity_ * s) * s : 0.;
    }
  };

  NSFD_REGISTER(VerificationRegistry, Ball, "ball",
                "Ball bouncing to rest: height summed over steps, final rest");
} // namespace nsfd
