#include "verification/rigid_motion_input.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Rod that slides on a rough plane (Painleve 1895). With the arm r from its
   * centre to the contact, I about the centre and sigma the sign of the
   * sliding, the contact accelerates upwards by b + p N,
   *
   *   p = 1/m + r_x (r_x + mu sigma r_y)/I,   b = -g - omega^2 r_y.
   *
   * For p > 0 and b < 0 it slides on with N = -b/p: an ordinary differential
   * equation. For p < 0 and b < 0 there is no force like that: the rod is
   * caught by an impact without collision. What stops the contact lies inside
   * the cone here, and the moment of momentum about the contact stays. For
   * p < 0 and b > 0 both are possible: to fly off, and to be caught.
   */
  class Painleve final : public VerificationCase
  {
  public:
    explicit Painleve(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      demand(input.dimension == 2, "the case is in the plane");
      demand_rigid(input);
      demand_box(input);
      body_ = stated_inertia(input);
      const ObstacleInput &plane = only_plane(input);
      demand(plane.normal[1] == 1. && input.gravity[0] == 0. &&
                 input.gravity[1] <= 0. && plane.restitution == 0.,
             "the plane must face up, gravity down, without restitution");
      friction_ = plane.friction;
      gravity_ = -input.gravity[1];
      for (unsigned int d = 0; d < 2; ++d)
        half_[d] = 0.5 * (input.mesh.upper[d] - input.mesh.lower[d]);
    }

    void observe(const StepView &view) override
    {
      using namespace space;
      const RigidState &rod = bodies_of(view, 1)[0];
      const double energy =
          kinetic_energy(body_, rod) + body_.mass * gravity_ * rod.centre[1];
      if (view.row->step == 0)
        start(rod);
      else {
        gain_ = std::max(gain_, energy - old_energy_);
        if (p_ > 0.)
          follow(rod, view.time_step);
        else if (view.row->step == 1)
          spin_ = rod.spin[2];
      }
      old_energy_ = energy;
    }

    /** Velocities over that of the start, p times the mass. */
    void finish(std::map<std::string, double> &errors) const override
    {
      errors["energy_gained"] = gain_ / kinetic_;
      errors["exact_p"] = body_.mass * p_;
      errors["exact_b_over_g"] = b_ / gravity_;
      if (p_ > 0.) {
        errors["angle"] = angle_;
        errors["velocity"] = velocity_ / speed_;
        errors["spin"] = spin_ * length_ / speed_;
        return;
      }
      // both ends of what may happen in the first step
      errors["caught"] = std::abs(spin_ - caught_spin_) * length_ / speed_;
      errors["flies"] = std::abs(spin_ - start_spin_) * length_ / speed_;
      errors["exact_impulse_ratio"] = impulse_ratio_;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("start", p_, b_, kinetic_, speed_, length_, sigma_,
                      arm_angle_, start_spin_, caught_spin_, impulse_ratio_);
      archive.numbers("smooth", motion_[0], motion_[1], motion_[2]);
      archive.numbers("found", gain_, old_energy_, angle_, velocity_, spin_);
    }

  private:
    using Motion = std::array<double, 3>; ///< angle, spin, v_x

    RigidInertia body_;
    double friction_ = 0., gravity_ = 0., half_[2] = {};
    double p_ = 0., b_ = 0., kinetic_ = 0., speed_ = 0., length_ = 0.,
           sigma_ = 0., arm_angle_ = 0.; ///< of the arm less that of the rod
    double start_spin_ = 0., caught_spin_ = 0., impulse_ratio_ = 0.;
    Motion motion_{};
    double gain_ = 0., old_energy_ = 0., angle_ = 0., velocity_ = 0.,
           spin_ = 0.;

    double moment() const { return body_.inertia[2][2]; }

    double p_of(const Vec3 &r) const
    {
      return 1. / body_.mass +
             r[0] * (r[0] + friction_ * sigma_ * r[1]) / moment();
    }

    Vec3 arm(const double angle) const
    {
      return {length_ * std::cos(arm_angle_ + angle),
              length_ * std::sin(arm_angle_ + angle), 0.};
    }

    /** The lowest corner is the contact. */
    void start(const RigidState &rod)
    {
      using namespace space;
      const Mat3 R = rotation(rod.orientation);
      Vec3 r{}, in_rod{};
      for (const double x : {-half_[0], half_[0]})
        for (const double y : {-half_[1], half_[1]}) {
          const Vec3 corner = R * Vec3{x, y, 0.};
          if (corner[1] < r[1]) {
            r = corner;
            in_rod = {x, y, 0.};
          }
        }
      length_ = norm(r);
      arm_angle_ = std::atan2(in_rod[1], in_rod[0]);
      start_spin_ = rod.spin[2];
      const Vec3 v = rod.velocity + cross({0., 0., start_spin_}, r);
      speed_ = std::abs(v[0]);
      demand(speed_ > 0. && std::abs(v[1]) < 1e-9 * speed_,
             "the contact must start along the plane");
      sigma_ = v[0] > 0. ? 1. : -1.;
      p_ = p_of(r);
      b_ = -gravity_ - start_spin_ * start_spin_ * r[1];
      demand(p_ < 0. || b_ < 0., "the rod flies off");
      kinetic_ = kinetic_energy(body_, rod);
      motion_ = {plane_angle(rod), start_spin_, rod.velocity[0]};
      const double about_contact =
          body_.mass * cross(-1. * r, rod.velocity)[2] + moment() * start_spin_;
      caught_spin_ = about_contact / (moment() + body_.mass * dot(r, r));
      const Vec3 change = cross({0., 0., caught_spin_}, -1. * r) - rod.velocity;
      impulse_ratio_ = std::abs(change[0]) / change[1];
      demand(p_ > 0. || (change[1] > 0. && impulse_ratio_ < friction_),
             "friction is too small to catch the rod");
    }

    /** Another step of the sliding rod, and how far the body is from it. */
    void follow(const RigidState &rod, const double h)
    {
      const auto rate = [this](const Motion &motion) {
        const Vec3 r = arm(motion[0]);
        const double spin = motion[1],
                     N = (gravity_ + spin * spin * r[1]) / p_of(r);
        return Motion{spin, N * (r[0] + friction_ * sigma_ * r[1]) / moment(),
                      -friction_ * sigma_ * N / body_.mass};
      };
      constexpr unsigned int n = 4;
      for (unsigned int k = 0; k < n; ++k)
        motion_ = runge_kutta(rate, motion_, h / n);
      angle_ = std::max(angle_, std::abs(plane_angle(rod) - motion_[0]));
      spin_ = std::max(spin_, std::abs(rod.spin[2] - motion_[1]));
      velocity_ = std::max(velocity_, std::abs(rod.velocity[0] - motion_[2]));
    }
  };

  NSFD_REGISTER(VerificationRegistry, Painleve, "painleve",
                "Rod sliding on a rough plane: smooth motion, or caught "
                "without a collision");
} // namespace nsfd
