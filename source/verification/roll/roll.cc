#include "verification/rigid_motion_input.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Ball that starts to slide on a plane, without spin: friction slows it and
   * turns it until it rolls, at v_0 / (mu g (1 + 1/k)), k = I/(m R^2), with
   * v_0/(1 + k): 2 v_0/(7 mu g) and 5 v_0/7 for a sphere, v_0/(3 mu g) and
   * 2 v_0/3 for a disc. From then on there is no friction.
   */
  class Roll final : public VerificationCase
  {
  public:
    explicit Roll(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      using namespace space;
      demand_rigid(input);
      gyration_ = gyration_of_ball(input);
      const ObstacleInput &plane = only_plane(input);
      normal_ = plane.normal;
      point_ = plane.point;
      const double g = -dot(input.gravity, normal_);
      demand(g > 0. && plane.friction > 0. &&
                 norm(input.gravity + g * normal_) < 1e-12 * g,
             "gravity must press the ball straight on a plane with friction");
      deceleration_ = plane.friction * g;
      end_ = input.time.end;
    }

    void observe(const StepView &view) override
    {
      using namespace space;
      const RigidState &ball = bodies_of(view, 1)[0];
      if (view.row->step == 0)
        start(ball);
      const double t = view.time, h = view.time_step, v_0 = norm(start_);
      const Vec3 direction = (1. / v_0) * start_;
      const double v = dot(ball.velocity, direction);
      const Vec3 slip =
          ball.velocity - radius_ * cross(spatial_spin(ball), normal_);
      const double s = dot(slip, direction);
      if (t <= roll_time_) {
        sliding_ = std::max(sliding_, std::abs(v - v_0 + deceleration_ * t));
        if (view.row->step > 0)
          measured_time_ = t + s * h / std::max(old_slip_ - s, 1e-300);
      }
      if (t - h >= roll_time_) {
        slip_ = std::max(slip_, norm(slip));
        velocity_ = std::max(
            velocity_, norm(ball.velocity - 1. / (1. + gyration_) * start_));
        friction_ =
            std::max(friction_, std::abs(v - old_) / (deceleration_ * h));
      }
      old_ = v;
      old_slip_ = s;
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      using namespace space;
      errors["sliding"] = sliding_ / norm(start_);
      errors["roll_time"] = relative_error(measured_time_, roll_time_);
      errors["velocity"] = velocity_ / norm(start_);
      errors["slip"] = slip_ / norm(start_);
      errors["friction_after"] = friction_;
      errors["exact_roll_time"] = roll_time_;
    }

    void serialize(Archive &archive) override
    {
      cases::serialize(archive, "start", start_);
      archive.numbers("found", radius_, roll_time_, sliding_, measured_time_,
                      slip_, velocity_, friction_, old_, old_slip_);
    }

  private:
    Vec3 normal_{}, point_{}, start_{};
    double gyration_ = 0., deceleration_ = 0., end_ = 0.;
    double radius_ = 0., roll_time_ = 0.;
    double sliding_ = 0., measured_time_ = 0., slip_ = 0., velocity_ = 0.,
           friction_ = 0., old_ = 0., old_slip_ = 0.;

    void start(const RigidState &ball)
    {
      using namespace space;
      start_ = ball.velocity;
      radius_ = dot(ball.centre - point_, normal_);
      const double v_0 = norm(start_);
      demand(v_0 > 0. && std::abs(dot(start_, normal_)) < 1e-12 * v_0 &&
                 radius_ * norm(ball.spin) < 1e-9 * v_0,
             "the ball must start along the plane, without spin");
      roll_time_ = v_0 / (deceleration_ * (1. + 1. / gyration_));
      demand(end_ > roll_time_, "the run ends before the ball rolls");
    }
  };

  NSFD_REGISTER(VerificationRegistry, Roll, "roll",
                "Sliding ball that begins to roll: time, speed, no friction "
                "afterwards");
} // namespace nsfd
