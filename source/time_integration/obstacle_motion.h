#pragma once

#include "bodies/contact_points.h"

#include <array>
#include <vector>

namespace nsfd
{
  /** Of obstacles at t = 0, as State::obstacle_shift: empty if none moves. */
  std::vector<double> initial_shifts(const SceneInput &input);

  /** Obstacles that move as the input says, and contacts with them. */
  template <int dim>
  class ObstacleMotion
  {
  public:
    ObstacleMotion(const SceneInput &input, const ContactPoints<dim> &contacts)
        : input_(input), contacts_(contacts)
    {
    }

    /** At the end of a step from @p old by the theta rule, as
        State::obstacle_shift. */
    std::vector<double> shifts(const State &old, double time_step) const;

    /** From H v of the bodies to that relative to the obstacles at @p time. */
    void subtract_velocity(double time, std::vector<double> &U) const;

    /** By contact of this rank, of these impulses over a step, J. */
    std::vector<double> work(const std::vector<double> &impulse, double start,
                             double time_step) const;

  private:
    std::array<double, dim> velocity(std::size_t row, double time) const;

    const SceneInput &input_;
    const ContactPoints<dim> &contacts_;
  };
} // namespace nsfd
