#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Block that slides on a level plane until friction stops it: after
   * t_s = v_0 / (mu g), at the distance v_0^2 / (2 mu g); friction has then
   * taken all of the kinetic energy, and the velocity is exactly 0.
   *
   * With dilatancy tan(psi) = a the block is thrown up as it starts to slide,
   * which leaves v_0 / (1 + mu a), and the climb presses it less: it stops at
   * the same time after v_0^2 / (2 mu g (1 + mu a)), lifted by a times that.
   * With wear k it sinks by k p times the distance, p = m g / A, as long as
   * k p is small.
   */
  class Stop final : public VerificationCase
  {
  public:
    explicit Stop(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      demand_box(input);
      demand(input.obstacles.size() == 1, "the case needs one Obstacle");
      const ObstacleInput &plane = input.obstacles[0];
      const Direction up = direction_of(plane.normal);
      const double pull = -up.sign * input.gravity[up.axis];
      demand(pull > 0. && plane.friction > 0.,
             "gravity must press the block on a plane with friction");
      const auto &lower = input.mesh.lower;
      for (unsigned int c = 0; c < input.dimension; ++c)
        velocity_[c] = input.materials[0].initial_velocity[c](
            lower[0], lower[1], input.dimension == 3 ? lower[2] : 0.);
      speed_ = std::hypot(velocity_[0], velocity_[1], velocity_[2]);
      demand(speed_ > 0. && velocity_[up.axis] == 0.,
             "the block must start along the plane");
      stop_time_ = speed_ / (plane.friction * pull);
      demand(input.time.end > stop_time_,
             "the run ends before the block stops");
      const SlidingInput &sliding = plane.sliding;
      demand(std::isinf(sliding.saturation) &&
                 (sliding.dilatancy == 0. || sliding.wear == 0.),
             "dilatancy without saturation, or wear, but not both");
      const double height = extent(input, up.axis),
                   p = input.materials[0].density * pull * height;
      climb_ = sliding.dilatancy - sliding.wear * p;
      exact_distance_ =
          0.5 * speed_ * stop_time_ / (1. + plane.friction * sliding.dilatancy);
      up_ = up.axis;
      up_sign_ = up.sign;
      lifts_ = sliding.lifts();
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      double v = 0., u = 0.; // along the initial velocity
      for (unsigned int c = 0; c < 3; ++c) {
        v += mean(*view.cells, &CellState::velocity, c) * velocity_[c] / speed_;
        u += mean(*view.cells, &CellState::displacement, c) * velocity_[c] /
             speed_;
      }
      distance_ = u;
      lift_ = up_sign_ * mean(*view.cells, &CellState::displacement, up_);
      const EnergyLines &e = view.row->energy;
      work_ = e.friction + e.impact - e.work;
      if (view.row->step == 0)
        kinetic_ = view.row->energy.kinetic;
      // the last full step of sliding tells when the velocity passes 0
      if (view.row->step > 0 && view.time <= stop_time_)
        measured_stop_ =
            view.time + v * view.time_step / std::max(old_ - v, 1e-300);
      if (view.time - view.time_step >= stop_time_)
        creep_ = std::max(creep_, std::abs(v));
      old_ = v;
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      errors["stop_time"] = relative_error(measured_stop_, stop_time_);
      errors["distance"] = relative_error(distance_, exact_distance_);
      errors["friction_work"] = relative_error(work_, kinetic_);
      if (lifts_)
        errors["lift"] = relative_error(lift_, climb_ * exact_distance_);
      errors["velocity_after_stop"] = creep_ / speed_;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", lift_, distance_, work_, kinetic_,
                      measured_stop_, creep_, old_);
    }

  private:
    Vector velocity_{};
    double speed_ = 0., stop_time_ = 0.;
    unsigned int up_ = 0;
    double up_sign_ = 1., climb_ = 0., exact_distance_ = 0., lift_ = 0.;
    bool lifts_ = false;
    double distance_ = 0., work_ = 0., kinetic_ = 0., measured_stop_ = 0.,
           creep_ = 0., old_ = 0.;
  };

  NSFD_REGISTER(
      VerificationRegistry, Stop, "stop",
      "Sliding block stopped by friction: time, distance, work, rest");
} // namespace nsfd
