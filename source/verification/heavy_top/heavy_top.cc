#include "verification/rigid_motion_input.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Symmetric top with a fixed point in steady precession: the axis, at the
   * angle theta to the vertical, turns with one of the roots Omega of
   *
   *   I_1 cos(theta) Omega^2 - I_3 omega_3 Omega + m g l = 0,
   *
   * I_1 about the fixed point, l from there to the centre of mass. Which root
   * it is, the initial velocity says.
   */
  class HeavyTop final : public VerificationCase
  {
  public:
    explicit HeavyTop(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      demand(input.dimension == 3 && input.pins.size() == 1,
             "the case needs three dimensions and one Pin");
      demand_rigid(input);
      body_ = stated_inertia(input);
      demand(body_.inertia[0][0] == body_.inertia[1][1],
             "the moments about x and y must be the same");
      demand(input.gravity[0] == 0. && input.gravity[1] == 0. &&
                 input.gravity[2] < 0.,
             "gravity must be along -z");
      gravity_ = -input.gravity[2];
      pin_ = input.pins[0].at;
    }

    void observe(const StepView &view) override
    {
      using namespace space;
      const RigidState &top = bodies_of(view, 1)[0];
      const Vec3 axis = rotation(top.orientation) * Vec3{0., 0., 1.};
      const double tilt = std::atan2(std::hypot(axis[0], axis[1]), axis[2]),
                   around = std::atan2(axis[1], axis[0]);
      const double energy = kinetic_energy(body_, top) +
                            body_.mass * gravity_ * (top.centre[2] - pin_[2]);
      if (view.row->step == 0) {
        start(top, tilt);
        energy_start_ = energy;
        azimuth_.start(around);
      }
      azimuth_.go_on(around);
      time_ = view.time;
      tilt_ = std::max(tilt_, std::abs(tilt - start_tilt_));
      energy_ = std::max(energy_, std::abs(energy - energy_start_) / kinetic_);
      spin_ = std::max(spin_, relative_error(top.spin[2], start_spin_));
      drift_ =
          std::max(drift_, norm(top.centre - pin_ - length_ * axis) / length_);
    }

    /** Angles in radians, lengths over that of the top. */
    void finish(std::map<std::string, double> &errors) const override
    {
      errors["rate"] = relative_error(azimuth_.turned() / time_, exact_rate_);
      errors["tilt"] = tilt_;
      errors["energy"] = energy_;
      errors["spin"] = spin_;
      errors["drift"] = drift_;
      errors["start"] = relative_error(start_rate_, exact_rate_);
      errors["exact_rate"] = exact_rate_;
    }

    void serialize(Archive &archive) override
    {
      azimuth_.serialize(archive, "azimuth");
      archive.numbers("start", length_, exact_rate_, start_rate_, start_tilt_,
                      start_spin_, kinetic_, energy_start_);
      archive.numbers("found", time_, tilt_, energy_, spin_, drift_);
    }

  private:
    RigidInertia body_;
    Vec3 pin_{};
    double gravity_ = 0., length_ = 0., exact_rate_ = 0., start_rate_ = 0.,
           start_tilt_ = 0., start_spin_ = 0., kinetic_ = 0.,
           energy_start_ = 0.;
    Turning azimuth_;
    double time_ = 0., tilt_ = 0., energy_ = 0., spin_ = 0., drift_ = 0.;

    void start(const RigidState &top, const double tilt)
    {
      using namespace space;
      length_ = norm(top.centre - pin_);
      start_tilt_ = tilt;
      start_spin_ = top.spin[2];
      kinetic_ = kinetic_energy(body_, top);
      // omega = Omega e_z + s axis
      const double c = std::cos(tilt), s = std::sin(tilt);
      demand(s > 0., "the axis must be off the vertical");
      start_rate_ = (spatial_spin(top)[2] - start_spin_ * c) / (s * s);
      const double a = (body_.inertia[0][0] + body_.mass * length_ * length_) *
                       c,
                   b = body_.inertia[2][2] * start_spin_,
                   d = body_.mass * gravity_ * length_,
                   square = b * b - 4. * a * d;
      demand(square > 0., "the top is too slow to precess steadily");
      const double fast = (b + std::sqrt(square)) / (2. * a),
                   slow = d / (a * fast);
      exact_rate_ = std::abs(start_rate_ - slow) < std::abs(start_rate_ - fast)
                        ? slow
                        : fast;
    }
  };

  NSFD_REGISTER(VerificationRegistry, HeavyTop, "heavy top",
                "Top with a fixed point: rate and tilt of steady precession");
} // namespace nsfd
