#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Elastic bar that flies against a rigid wall, the first benchmark of Doyen,
   * Ern and Piperno (SIAM J. Sci. Comput. 33, 2011). With x the distance from
   * the front end, v_0 the speed towards the wall, T = L/c and s the time
   * since the impact,
   *
   *   u = -v_0 t + v_0 <s - x/c> + v_0 <s + x/c - 2T>
   *
   * at all times: contact for 0 < s < 2T under the pressure rho c v_0, then
   * the bar flies back with v_0 and without stress. The impulse of the wall is
   * 2 rho L v_0 per area, and no energy is lost.
   */
  class BarWall final : public VerificationCase
  {
  public:
    explicit BarWall(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      bar_ = bar_of(input);
      demand(input.obstacles.size() == 1, "the case needs one Obstacle");
      const ObstacleInput &wall = input.obstacles[0];
      direction_ = direction_of(wall.normal);
      const unsigned int d = direction_.axis;
      front_ = (direction_.sign > 0. ? input.mesh.lower : input.mesh.upper)[d];
      length_ = extent(input, d);
      speed_ = -direction_.sign *
               input.materials[0].initial_velocity[d](
                   input.mesh.lower[0], input.mesh.lower[1],
                   input.dimension == 3 ? input.mesh.lower[2] : 0.);
      const double gap = direction_.sign * (front_ - wall.point[d]);
      demand(speed_ > 0. && gap >= 0., "the bar must fly towards the wall");
      impact_time_ = gap / speed_;
      crossing_ = length_ / bar_.speed;
    }

    bool has_fields() const override { return true; }

    Vector displacement(const Vector &x, const double t) const override
    {
      const double s = t - impact_time_, delay = delay_of(x);
      return along(speed_ * (-t + positive_part(s - delay) +
                             positive_part(s + delay - 2. * crossing_)));
    }

    Vector velocity(const Vector &x, const double t) const override
    {
      const double s = t - impact_time_, delay = delay_of(x);
      return along(speed_ * (-1. + heaviside(s - delay) +
                             heaviside(s + delay - 2. * crossing_)));
    }

    bool wants_cells() const override { return true; }
    bool wants_opening() const override { return true; }

    void observe(const StepView &view) override
    {
      if (view.row->step == 0)
        initial_opening_ = view.opening;
      else if (view.time > 1.1 * (impact_time_ + 2. * crossing_))
        compare_front(view);
      time_ = view.time;
      mean_velocity_ = direction_.sign *
                       mean(*view.cells, &CellState::velocity, direction_.axis);
      energy_ = mechanical_energy(*view.row);
      if (view.row->step == 0)
        initial_energy_ = energy_;
    }

    /**
     * Impulse from the momentum of the bar, the share of energy lost, and, if
     * the run goes beyond 1.1 times the end of contact, the mean errors of the
     * front end from then on, over its mean distance from the wall and speed.
     */
    void finish(std::map<std::string, double> &errors) const override
    {
      // rho c v_0 for the time of contact, over the mass rho L
      const double exact = bar_.speed * speed_ / length_ *
                           std::clamp(time_ - impact_time_, 0., 2. * crossing_);
      if (exact > 0.)
        errors["impulse"] = relative_error(mean_velocity_ + speed_, exact);
      errors["energy"] = std::abs(1. - energy_ / initial_energy_);
      if (front_speed_ > 0.) {
        errors["front_displacement"] =
            front_displacement_error_ / front_distance_;
        errors["front_velocity"] = front_velocity_error_ / front_speed_;
      }
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", time_, mean_velocity_, energy_, initial_energy_,
                      initial_opening_, front_displacement_error_,
                      front_distance_, front_velocity_error_, front_speed_);
    }

  private:
    Bar bar_;
    Direction direction_; // of the normal of the wall
    double front_ = 0., length_ = 0., speed_ = 0.;
    double impact_time_ = 0., crossing_ = 0.;
    double time_ = 0., mean_velocity_ = 0., energy_ = 0., initial_energy_ = 0.;

    double initial_opening_ = 0.;
    /// sums over steps in free flight, weighted with the step
    double front_displacement_error_ = 0., front_distance_ = 0.,
           front_velocity_error_ = 0., front_speed_ = 0.;

    void compare_front(const StepView &view)
    {
      Vector x{};
      x[direction_.axis] = front_;
      const unsigned int d = direction_.axis;
      const double u = direction_.sign * displacement(x, view.time)[d],
                   v = direction_.sign * velocity(x, view.time)[d],
                   h = view.time_step;
      const double distance = initial_opening_ + u;
      front_distance_ += h * distance;
      front_speed_ += h * std::abs(v);
      front_displacement_error_ += h * std::abs(view.opening - distance);
      front_velocity_error_ += h * std::abs(view.opening_rate - v);
    }

    /** Time of a wave from the front end to x. */
    double delay_of(const Vector &x) const
    {
      return direction_.sign * (x[direction_.axis] - front_) / bar_.speed;
    }

    /** A vector away from the wall. */
    Vector along(const double value) const
    {
      Vector result{};
      result[direction_.axis] = direction_.sign * value;
      return result;
    }
  };

  NSFD_REGISTER(VerificationRegistry, BarWall, "bar wall",
                "Elastic bar hits a rigid wall: fields, impulse, energy lost");
} // namespace nsfd
