#pragma once

#include "nsfd/parameters/expression.h"
#include "nsfd/scene/heat_input.h"
#include "nsfd/scene/sliding_input.h"
#include "nsfd/scene/where_input.h"

#include <array>
#include <memory>
#include <optional>
#include <string>

namespace nsfd
{
  class ObstacleShape; // see obstacles/obstacle_shape.h

  /** A rigid half space, ball or cylinder; boundary faces may touch it. */
  struct ObstacleInput {
    std::string name;
    Where where;                      ///< boundary faces that may touch it
    std::string shape_name = "plane"; ///< as the file writes it
    std::shared_ptr<const ObstacleShape> shape;
    std::array<double, 3> point{}; ///< on the plane, centre, or on the axis
    /// of a plane, out of the obstacle; axis of a cylinder; unit length
    std::array<double, 3> normal{};
    double radius = 0.;
    bool hollow = false; ///< bodies are inside: a shell, a drum, a pipe
    /// of the whole obstacle, m/s, functions of t; all empty: it stands still
    std::array<std::optional<Expression>, 3> velocity;
    double friction = 0., restitution = 0.;
    TemperatureFactor friction_factor;
    SlidingInput sliding;
    /// the block of SceneInput::interfaces with its law; -1: none
    int cohesion = -1;

    bool moves() const { return velocity[0] || velocity[1] || velocity[2]; }
  };
} // namespace nsfd
