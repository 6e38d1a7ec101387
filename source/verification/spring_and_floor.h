#pragma once

#include "nsfd/verification/case_input.h"

namespace nsfd::cases
{
  /**
   * Two rigid bodies next to each other in x, joined by springs on their face:
   * the left one is held or driven, the right one presses on a plane with
   * friction. Everything that a mass m on a spring k needs.
   */
  struct SpringAndFloor {
    double stiffness = 0., mass = 0., friction_force = 0.;

    /** sqrt(k/m) */
    double frequency() const { return std::sqrt(stiffness / mass); }

    /** mu m g / k: what friction holds the spring at. */
    double held_length() const { return friction_force / stiffness; }

    explicit SpringAndFloor(const SceneInput &input)
    {
      demand_box(input);
      demand(input.dimension == 2 &&
                 input.mesh.cells == std::vector<unsigned int>({2, 1}),
             "the case needs two cells next to each other");
      demand(input.obstacles.size() == 1, "the case needs one Obstacle");
      const ObstacleInput &floor = input.obstacles[0];
      const Direction up = direction_of(floor.normal);
      const double pull = -up.sign * input.gravity[up.axis];
      demand(up.axis == 1 && pull > 0. && floor.friction > 0.,
             "gravity must press the right block on a floor with friction");
      const double width = 0.5 * extent(input, 0), height = extent(input, 1);
      const MaterialInput &block =
          material_at(input, {{input.mesh.upper[0] - 0.5 * width,
                               input.mesh.lower[1] + 0.5 * height, 0.}});
      demand(block.rigid, "the block must be rigid");
      stiffness = elastic_interface(input).normal_stiffness * height;
      mass = block.density * width * height;
      friction_force = floor.friction * mass * pull;
    }
  };

  /** The right one of the two. */
  inline const CellState &block_of(const StepView &view)
  {
    return view.cells->back();
  }
} // namespace nsfd::cases
