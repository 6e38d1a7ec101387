#include "verification/rigid_motion_input.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Central impact of two bodies without friction, with w = v_1 - v_2:
   *
   *   v_1' = v_1 - (1 + e) m_2/(m_1 + m_2) w,
   *   v_2' = v_2 + (1 + e) m_1/(m_1 + m_2) w,
   *
   * and (1 - e^2)/2 m_1 m_2/(m_1 + m_2) w^2 is lost. The materials stand in the
   * order of the bodies.
   */
  class TwoBodies final : public VerificationCase
  {
  public:
    explicit TwoBodies(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      demand_rigid(input);
      demand(input.materials.size() == 2 && input.contacts.size() == 1,
             "the case needs two materials and one Contact");
      for (unsigned int k = 0; k < 2; ++k) {
        const auto &mass = input.materials[k].rigid_bodies.mass;
        demand(mass.has_value(), "both materials must state their mass");
        mass_[k] = *mass;
      }
      restitution_ = input.contacts[0].restitution;
    }

    void observe(const StepView &view) override
    {
      using namespace space;
      const auto &bodies = bodies_of(view, 2);
      if (view.row->step == 0)
        start(bodies);
      Vec3 momentum{};
      for (unsigned int k = 0; k < 2; ++k) {
        velocity_[k] = bodies[k].velocity;
        momentum = momentum + mass_[k] * velocity_[k];
      }
      momentum_ = std::max(
          momentum_, norm(momentum - total_) /
                         (mass_[0] * norm(old_[0]) + mass_[1] * norm(old_[1])));
      lost_ = view.row->energy.impact;
    }

    /** Velocities over that of the approach. */
    void finish(std::map<std::string, double> &errors) const override
    {
      using namespace space;
      const Vec3 w = old_[0] - old_[1];
      const double mass = mass_[0] + mass_[1];
      for (unsigned int k = 0; k < 2; ++k) {
        const double share =
            (k == 0 ? -1. : 1.) * (1. + restitution_) * mass_[1 - k] / mass;
        errors["velocity_" + std::to_string(k + 1)] =
            norm(velocity_[k] - old_[k] - share * w) / norm(w);
      }
      const double energy = 0.5 * mass_[0] * mass_[1] / mass * dot(w, w);
      errors["lost"] =
          std::abs(lost_ / energy - (1. - restitution_ * restitution_));
      errors["momentum"] = momentum_;
    }

    void serialize(Archive &archive) override
    {
      for (unsigned int k = 0; k < 2; ++k) {
        cases::serialize(archive, "old_" + std::to_string(k), old_[k]);
        cases::serialize(archive, "new_" + std::to_string(k), velocity_[k]);
      }
      cases::serialize(archive, "total", total_);
      archive.numbers("found", momentum_, lost_);
    }

  private:
    double mass_[2] = {}, restitution_ = 0.;
    Vec3 old_[2] = {}, velocity_[2] = {}, total_{};
    double momentum_ = 0., lost_ = 0.;

    void start(const std::vector<RigidState> &bodies)
    {
      using namespace space;
      for (unsigned int k = 0; k < 2; ++k) {
        old_[k] = bodies[k].velocity;
        total_ = total_ + mass_[k] * old_[k];
      }
      const Vec3 w = old_[0] - old_[1],
                 line = bodies[1].centre - bodies[0].centre;
      demand(dot(w, line) > 0. &&
                 norm(cross(w, line)) < 1e-9 * norm(w) * norm(line),
             "the bodies must approach along the line of their centres");
    }
  };

  NSFD_REGISTER(VerificationRegistry, TwoBodies, "two bodies",
                "Central impact of two rigid bodies: velocities, momentum, "
                "energy lost");
} // namespace nsfd
