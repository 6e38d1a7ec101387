#include "verification/rigid_motion_input.h"

namespace nsfd
{
  using namespace cases;

  /**
   * Ball without spin that hits a wall with v_n into it and v_t along it. The
   * normal part comes back as e v_n, with the impulse (1 + e) m v_n. To stick
   * takes k/(1 + k) m v_t along the wall, k = I/(m R^2), 2/7 m v_t for a
   * sphere: for mu (1 + e) v_n above that v_t' = v_t/(1 + k) and the ball
   * rolls, else v_t' = v_t - mu (1 + e) v_n. The spin takes m dv_t^2/(2 k).
   */
  class ObliqueImpact final : public VerificationCase
  {
  public:
    explicit ObliqueImpact(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      using namespace space;
      demand_rigid(input);
      gyration_ = gyration_of_ball(input);
      const ObstacleInput &wall = only_plane(input);
      normal_ = wall.normal;
      friction_ = wall.friction;
      restitution_ = wall.restitution;
      demand(norm(input.gravity) == 0., "the case is without gravity");
    }

    void observe(const StepView &view) override
    {
      using namespace space;
      const RigidState &ball = bodies_of(view, 1)[0];
      velocity_ = ball.velocity;
      kinetic_ = view.row->energy.kinetic;
      if (view.row->step > 0)
        return;
      start_ = velocity_;
      kinetic_start_ = kinetic_;
      demand(dot(start_, normal_) < 0. && tangential(start_) > 0.,
             "the ball must move towards the wall and along it");
    }

    /** Velocities over the speed before, the energy over that before. */
    void finish(std::map<std::string, double> &errors) const override
    {
      using namespace space;
      const double v_n = -dot(start_, normal_), v_t = tangential(start_),
                   speed = norm(start_), k = gyration_,
                   impulse = (1. + restitution_) * v_n;
      const double threshold = k / (1. + k) * v_t / impulse;
      const double exact =
          friction_ >= threshold ? v_t / (1. + k) : v_t - friction_ * impulse;
      const Vec3 along = (1. / v_t) * (start_ + v_n * normal_);
      errors["normal"] =
          std::abs(dot(velocity_, normal_) - restitution_ * v_n) / speed;
      errors["tangential"] = std::abs(dot(velocity_, along) - exact) / speed;
      const double squares = restitution_ * restitution_ * v_n * v_n +
                             exact * exact + (v_t - exact) * (v_t - exact) / k;
      errors["energy"] =
          std::abs(kinetic_ / kinetic_start_ - squares / (speed * speed));
      errors["exact_threshold"] = threshold;
      errors["exact_tangential"] = exact;
    }

    void serialize(Archive &archive) override
    {
      cases::serialize(archive, "start", start_);
      cases::serialize(archive, "velocity", velocity_);
      archive.numbers("found", kinetic_, kinetic_start_);
    }

  private:
    Vec3 normal_{}, start_{}, velocity_{};
    double gyration_ = 0., friction_ = 0., restitution_ = 0.;
    double kinetic_ = 0., kinetic_start_ = 0.;

    double tangential(const Vec3 &v) const
    {
      using namespace space;
      return norm(v - dot(v, normal_) * normal_);
    }
  };

  NSFD_REGISTER(VerificationRegistry, ObliqueImpact, "oblique impact",
                "Ball hits a wall with friction: sticks or slides, spin");
} // namespace nsfd
