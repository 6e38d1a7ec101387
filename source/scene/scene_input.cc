#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  bool has_sliding_lift(const SceneInput &input)
  {
    const auto lifts = [](const auto &block) { return block.sliding.lifts(); };
    return std::any_of(input.interfaces.begin(), input.interfaces.end(),
                       lifts) ||
           std::any_of(input.obstacles.begin(), input.obstacles.end(), lifts) ||
           std::any_of(input.contacts.begin(), input.contacts.end(), lifts);
  }

  double SceneInput::front_viscosity() const
  {
    // tension behind a compressive front is then at most 4 % of its amplitude
    constexpr double automatic = 0.2;
    if (!time.scheme.at_nodes)
      return 0.;
    if (time.front_viscosity)
      return *time.front_viscosity;
    return std::any_of(
               interfaces.begin(), interfaces.end(),
               [](const InterfaceInput &block) { return bool(block.law); })
               ? automatic
               : 0.;
  }

  bool has_opening_viscosity(const SceneInput &input)
  {
    return std::any_of(input.interfaces.begin(), input.interfaces.end(),
                       [](const InterfaceInput &block) {
                         return block.opening_viscosity > 0.;
                       });
  }

  bool has_crack_pressure(const SceneInput &input)
  {
    return std::any_of(
        input.interfaces.begin(), input.interfaces.end(),
        [](const InterfaceInput &block) { return bool(block.crack_pressure); });
  }

  bool has_warm_friction(const SceneInput &input)
  {
    return std::any_of(input.interfaces.begin(), input.interfaces.end(),
                       [](const InterfaceInput &block) {
                         return block.heat.friction.is_given();
                       }) ||
           std::any_of(input.obstacles.begin(), input.obstacles.end(),
                       [](const ObstacleInput &obstacle) {
                         return obstacle.friction_factor.is_given();
                       });
  }

  bool has_heated_sides(const SceneInput &input)
  {
    return std::any_of(input.boundaries.begin(), input.boundaries.end(),
                       [](const BoundaryInput &boundary) {
                         return boundary.temperature || boundary.heat_flux;
                       });
  }

  bool has_warm_laws(const SceneInput &input)
  {
    return std::any_of(
        input.interfaces.begin(), input.interfaces.end(),
        [](const InterfaceInput &block) { return block.heat.changes_law(); });
  }
} // namespace nsfd
