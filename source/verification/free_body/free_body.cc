#include "verification/rigid_motion_input.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Rigid body that turns without any load: its energy and its angular momentum
   * L are constant. If I_1 = I_2, its axis turns about L with L/I_1, and the
   * spin about the axis with (I_3 - I_1)/I_1 W_3 in the body. If it turns about
   * the axis of the middle moment, W_2, this is unstable: it turns over again
   * and again, at the zeros of W_2 of Euler's equations.
   */
  class FreeBody final : public VerificationCase
  {
  public:
    explicit FreeBody(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      demand(input.dimension == 3, "the case is in space");
      demand_rigid(input);
      demand(input.obstacles.empty() && input.pins.empty() &&
                 input.gravity == Vec3{},
             "the body must be free, without gravity");
      body_ = stated_inertia(input);
      end_ = input.time.end;
    }

    void observe(const StepView &view) override
    {
      using namespace space;
      const RigidState &body = bodies_of(view, 1)[0];
      const bool begins = view.row->step == 0;
      if (begins)
        start(body);
      energy_ = std::max(energy_,
                         relative_error(kinetic_energy(body_, body), kinetic_));
      const Vec3 L = angular_momentum(body_, body);
      momentum_ = std::max(momentum_, norm(L - L_) / norm(L_));
      const Quaternion &q = body.orientation;
      orthogonality_ =
          std::max(orthogonality_, std::abs(q[0] * q[0] + q[1] * q[1] +
                                            q[2] * q[2] + q[3] * q[3] - 1.));
      time_ = view.time;
      if (is_symmetric())
        follow_axis(body, begins);
      else if (flips_) {
        const double W = body.spin[1], h = view.time_step;
        if (!begins && W * old_ < 0.)
          note_flip(view.time - h * W / (W - old_), measured_);
        old_ = W;
      }
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      errors["energy"] = energy_;
      errors["momentum"] = momentum_;
      errors["orthogonality"] = orthogonality_;
      if (is_symmetric()) {
        errors["spatial_rate"] =
            relative_error(in_space_.turned() / time_, spatial_rate());
        errors["body_rate"] =
            relative_error(in_body_.turned() / time_, body_rate());
        errors["tilt"] = tilt_;
        errors["exact_spatial_rate"] = spatial_rate();
        errors["exact_body_rate"] = body_rate();
      } else if (flips_) {
        const Flips exact = exact_flips();
        errors["flips"] = std::abs(measured_.count - exact.count);
        errors["first_flip"] = relative_error(measured_.first, exact.first);
        errors["period"] = relative_error(measured_.period(), exact.period());
        errors["exact_first_flip"] = exact.first;
        errors["exact_period"] = exact.period();
      }
    }

    void serialize(Archive &archive) override
    {
      cases::serialize(archive, "L", L_);
      cases::serialize(archive, "W", W_);
      cases::serialize(archive, "side", side_);
      in_space_.serialize(archive, "in_space");
      in_body_.serialize(archive, "in_body");
      archive.numbers("flips", flips_, measured_.count, measured_.first,
                      measured_.last, old_);
      archive.numbers("found", kinetic_, start_tilt_, time_, energy_, momentum_,
                      orthogonality_, tilt_);
    }

  private:
    struct Flips {
      double count = 0., first = 0., last = 0.;
      double period() const { return (last - first) / (count - 1.); }
    };

    RigidInertia body_;
    double end_ = 0.;
    Vec3 L_{}, W_{}, side_{}; ///< at the start; a direction across L
    double kinetic_ = 0., start_tilt_ = 0., time_ = 0.;
    double energy_ = 0., momentum_ = 0., orthogonality_ = 0., tilt_ = 0.;
    Turning in_space_, in_body_;
    bool flips_ = false;
    Flips measured_;
    double old_ = 0.;

    double moment(const unsigned int i) const { return body_.inertia[i][i]; }

    bool is_symmetric() const
    {
      return moment(0) == moment(1) && moment(2) != moment(0);
    }
    double spatial_rate() const { return space::norm(L_) / moment(0); }
    double body_rate() const
    {
      return (moment(2) - moment(0)) / moment(0) * W_[2];
    }

    void start(const RigidState &body)
    {
      using namespace space;
      kinetic_ = kinetic_energy(body_, body);
      demand(kinetic_ > 0., "the body must turn");
      L_ = angular_momentum(body_, body);
      W_ = body.spin;
      flips_ = (moment(1) - moment(0)) * (moment(2) - moment(1)) > 0. &&
               std::abs(W_[1]) > std::max(std::abs(W_[0]), std::abs(W_[2]));
      const Vec3 axis = axis_of(body);
      side_ = axis - dot(axis, L_) / dot(L_, L_) * L_;
      demand(!is_symmetric() || norm(side_) > 0.,
             "the axis must be off the angular momentum");
    }

    Vec3 axis_of(const RigidState &body) const
    {
      using namespace space;
      return rotation(body.orientation) * Vec3{0., 0., 1.};
    }

    void follow_axis(const RigidState &body, const bool begins)
    {
      using namespace space;
      const Vec3 axis = axis_of(body);
      const double along = dot(axis, L_) / norm(L_),
                   tilt = std::atan2(norm(cross(axis, L_)) / norm(L_), along);
      const double around =
          std::atan2(dot(axis, cross(L_, side_)) / norm(L_), dot(axis, side_));
      const double inside = std::atan2(body.spin[1], body.spin[0]);
      if (begins) {
        start_tilt_ = tilt;
        in_space_.start(around);
        in_body_.start(inside);
      }
      in_space_.go_on(around);
      in_body_.go_on(inside);
      tilt_ = std::max(tilt_, std::abs(tilt - start_tilt_));
    }

    static void note_flip(const double time, Flips &flips)
    {
      if (flips.count == 0.)
        flips.first = time;
      flips.last = time;
      flips.count += 1.;
    }

    Flips exact_flips() const
    {
      const auto rate = [this](const Vec3 &W) {
        return Vec3{(moment(1) - moment(2)) / moment(0) * W[1] * W[2],
                    (moment(2) - moment(0)) / moment(1) * W[2] * W[0],
                    (moment(0) - moment(1)) / moment(2) * W[0] * W[1]};
      };
      const double h = 1e-3 / space::norm(W_);
      Flips flips;
      Vec3 W = W_;
      for (double t = 0.; t < end_; t += h) {
        const Vec3 next = runge_kutta(rate, W, h);
        if (next[1] * W[1] < 0.)
          note_flip(t + h * W[1] / (W[1] - next[1]), flips);
        W = next;
      }
      return flips;
    }
  };

  NSFD_REGISTER(VerificationRegistry, FreeBody, "free body",
                "Free rigid body: energy, angular momentum, precession or "
                "turning over");
} // namespace nsfd
