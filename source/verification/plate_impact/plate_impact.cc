#include "verification/spalling_plane.h"

#include "nsfd/core/archive.h"

#include <optional>

namespace nsfd
{
  using namespace cases;

  /**
   * A flyer of length L_f hits at speed V a target of length L_t > 2 L_f of the
   * same material, which it touches at the start. With Z = rho c, the stress is
   * -Z V/2 in both. The flyer comes to rest at 2 L_f/c, and the free face of
   * the target moves at V from L_t/c. The first tension, Z V/2, is at L_f from
   * that face at (L_t + L_f)/c. From (L_t + 2 L_f)/c on, a plane there with
   * the traction T(s), s since its tension, see SpallingPlane, lets the free
   * face move at
   *
   *   V - 2 T(s - L_f/c)/Z,
   *
   * and at 0 if it holds. Exact until waves come back at (L_t + 4 L_f)/c.
   */
  class PlateImpact final : public VerificationCase
  {
  public:
    explicit PlateImpact(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      bar_ = bar_of(input);
      const double y = 0.5 * (input.mesh.lower[1] + input.mesh.upper[1]);
      const double lower = input.mesh.lower[0], length = extent(input, 0);
      const double n = n_cells(input, 0);
      unsigned int n_flyer = 0;
      for (unsigned int i = 0; i < n; ++i) {
        const std::array<double, 3> x = {
            {lower + (i + 0.5) * length / n, y, 0.}};
        const double v = material_at(input, x).initial_velocity[0](x[0], y, 0.);
        if (v == 0.)
          break;
        demand(v > 0. && (i == 0 || v == speed_),
               "the flyer, on the left, moves to the right at one speed");
        speed_ = v;
        ++n_flyer;
      }
      flyer_ = n_flyer * length / n;
      target_ = length - flyer_;
      contact_ = lower + flyer_;
      free_face_ = lower + length;
      demand(n_flyer > 0 && target_ > 2. * flyer_,
             "the target must be more than twice as long as the flyer");
      demand(input.time.end <=
                 (target_ + 4. * flyer_) / bar_.speed * (1. + 1e-9),
             "the solution is known until t = (L_t + 4 L_f)/c");
      stress_ = 0.5 * bar_.impedance() * speed_;
      threshold_ = 0.5 * stress_;
      for (const InterfaceInput &interface : input.interfaces)
        if (interface.law && interface.law->strength() < stress_ && !plane_) {
          const CohesiveLaw &law = *interface.law;
          plane_.emplace(law, stress_, bar_.impedance());
          toughness_ = law.toughness() * cross_section(input, 0);
          demand(law.strength() > threshold_,
                 "the strength must exceed half of the tension");
        }
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      const double t = view.time;
      const CellState *last = nullptr, *most = nullptr;
      double flyer = 0., flyer_volume = 0.;
      for (const CellState &cell : *view.cells) {
        const double x = cell.centre[0];
        if (last == nullptr || x > last->centre[0])
          last = &cell;
        if (x < contact_) {
          flyer += cell.volume * cell.velocity[0];
          flyer_volume += cell.volume;
          continue;
        }
        if (most == nullptr || cell.stress[0] > most->stress[0])
          most = &cell;
        // the middle half of the pulse, away from its fronts
        const double behind = bar_.speed * t - (x - contact_);
        if (behind > 0.5 * flyer_ && behind < 1.5 * flyer_ &&
            t < target_ / bar_.speed) {
          pulse_stress_ += view.time_step * cell.stress[0];
          pulse_time_ += view.time_step;
        }
      }
      flyer_velocity_ = flyer / flyer_volume;
      if (tension_time_ < 0. && most->stress[0] > threshold_) {
        tension_time_ = t;
        tension_place_ = free_face_ - most->centre[0];
      }

      // the velocity of the last cell, at half a cell from the face
      const double exact = face_velocity(t);
      difference_ += view.time_step * std::abs(last->velocity[0] - exact);
      reference_ += view.time_step * std::abs(exact);
      if (t > (target_ + flyer_) / bar_.speed)
        lost_ += view.time_step * (speed_ - last->velocity[0]);
      damage_ = view.row->energy.damage;
    }

    /** `pullback`: the path by which the dip delays the free face. */
    void finish(std::map<std::string, double> &errors) const override
    {
      if (pulse_time_ > 0.)
        errors["stress"] =
            relative_error(pulse_stress_ / pulse_time_, -stress_);
      if (tension_time_ >= 0.) {
        errors["tension_time"] =
            relative_error(tension_time_, (target_ + flyer_) / bar_.speed);
        errors["tension_place"] = relative_error(tension_place_, flyer_);
      }
      if (reference_ > 0.)
        errors["face_velocity_L1"] = difference_ / reference_;
      errors["flyer_velocity"] = std::abs(flyer_velocity_) / speed_;
      if (plane_) {
        errors["damage"] = relative_error(damage_, toughness_);
        errors["pullback"] =
            relative_error(lost_, 2. * plane_->impulse() / bar_.impedance());
      }
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", pulse_stress_, pulse_time_, tension_time_,
                      tension_place_, difference_, reference_, flyer_velocity_,
                      lost_, damage_);
    }

  private:
    Bar bar_;
    std::optional<SpallingPlane> plane_;
    double speed_ = 0., flyer_ = 0., target_ = 0., contact_ = 0.,
           free_face_ = 0., stress_ = 0., threshold_ = 0., toughness_ = 0.;
    double pulse_stress_ = 0., pulse_time_ = 0., tension_time_ = -1.,
           tension_place_ = 0., difference_ = 0., reference_ = 0.,
           flyer_velocity_ = 0., lost_ = 0., damage_ = 0.;

    double face_velocity(const double t) const
    {
      const double s = t - (target_ + 2. * flyer_) / bar_.speed;
      if (t < target_ / bar_.speed)
        return 0.;
      if (s < 0.)
        return speed_;
      return plane_ ? speed_ - 2. * plane_->traction(s) / bar_.impedance() : 0.;
    }
  };

  NSFD_REGISTER(VerificationRegistry, PlateImpact, "plate impact",
                "Flyer hits a target: stress, first tension, velocity of the "
                "free face without and with spall");
} // namespace nsfd
