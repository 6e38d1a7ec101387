#include "verification/rigid_motion_input.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Block of half width b and half height a that rocks on a rough plane
   * (Housner 1963). With tan alpha = b/a, R the half diagonal and
   * p^2 = 3 g/(4 R) it turns about one corner by
   *
   *   theta'' = -p^2 sin(alpha - theta),
   *
   * from rest at theta_0 until it is upright. There the other corner hits the
   * plane; with e = 0 and the moment of momentum about it the spin falls by
   * the factor 1 - (3/2) sin^2 alpha.
   */
  class RockingBlock final : public VerificationCase
  {
  public:
    explicit RockingBlock(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      demand(input.dimension == 2, "the case is in the plane");
      demand_rigid(input);
      demand_box(input);
      const RigidInput &rigid = input.materials[0].rigid_bodies;
      demand(!rigid.mass && !rigid.inertia && !rigid.ball,
             "the block must be homogeneous");
      const ObstacleInput &plane = only_plane(input);
      demand(plane.normal[1] == 1. && plane.restitution == 0. &&
                 input.gravity[0] == 0. && input.gravity[1] < 0.,
             "the plane must face up, gravity down, without restitution");
      const double b = 0.5 * extent(input, 0), a = 0.5 * extent(input, 1);
      alpha_ = std::atan2(b, a);
      squared_rate_ = -0.75 * input.gravity[1] / std::hypot(a, b);
    }

    void observe(const StepView &view) override
    {
      const RigidState &block = bodies_of(view, 1)[0];
      const double angle = plane_angle(block), spin = block.spin[2];
      if (view.row->step == 0) {
        side_ = angle > 0. ? 1. : -1.;
        start_ = std::abs(angle);
        demand(start_ > 0. && start_ < alpha_ && spin == 0.,
               "the block must start tilted, at rest");
      } else {
        if (measured_time_ == 0. && side_ * angle <= 0.)
          measured_time_ =
              view.time - view.time_step * angle / (angle - old_angle_);
        // the spin grows until the impact
        if (before_ == 0. && std::abs(spin) < std::abs(old_spin_)) {
          before_ = upright_spin(old_angle_, old_spin_);
          after_ = upright_spin(angle, spin);
        }
      }
      old_angle_ = angle;
      old_spin_ = spin;
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      const double before = upright_spin(start_, 0.),
                   ratio = 1. - 1.5 * std::pow(std::sin(alpha_), 2),
                   time = exact_time();
      errors["impact_time"] = relative_error(measured_time_, time);
      errors["spin_before"] = relative_error(before_, before);
      errors["spin_after"] = relative_error(after_, ratio * before);
      errors["exact_impact_time"] = time;
      errors["exact_spin_before"] = before;
      errors["exact_spin_after"] = ratio * before;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", side_, start_, measured_time_, before_, after_,
                      old_angle_, old_spin_);
    }

  private:
    double alpha_ = 0., squared_rate_ = 0.;
    double side_ = 0., start_ = 0., measured_time_ = 0., before_ = 0.,
           after_ = 0., old_angle_ = 0., old_spin_ = 0.;

    /** By the energy: of the block as it passes, or left, the upright. */
    double upright_spin(const double angle, const double spin) const
    {
      return std::sqrt(spin * spin + 2. * squared_rate_ *
                                         (std::cos(alpha_ - std::abs(angle)) -
                                          std::cos(alpha_)));
    }

    double exact_time() const
    {
      using Motion = std::array<double, 2>; // angle, spin
      const auto rate = [this](const Motion &motion) {
        return Motion{motion[1], -squared_rate_ * std::sin(alpha_ - motion[0])};
      };
      const double h = 1e-4 / std::sqrt(squared_rate_);
      Motion motion{start_, 0.}, old = motion;
      double t = 0.;
      for (; motion[0] > 0.; t += h) {
        old = motion;
        motion = runge_kutta(rate, motion, h);
      }
      return t - h * motion[0] / (motion[0] - old[0]);
    }
  };

  NSFD_REGISTER(VerificationRegistry, RockingBlock, "rocking block",
                "Block that rocks on its corners: time of the first impact, "
                "spin before and after");
} // namespace nsfd
