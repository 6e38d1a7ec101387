#pragma once

#include <map>
#include <string>

namespace wall
{
  /** A scene as a user might write it, drawn from a seed. */
  struct DrawnScene {
    /// motion, integrator, what bodies do, whether they touch
    std::string kind;
    std::string text; ///< of the parameter file
    /// other files by their names: meshes
    std::map<std::string, std::string> files;
    double end = 0.;            ///< s
    bool keeps_momentum = true; ///< no load, support, drive or obstacle
  };

  /** The same scene for a seed at all times. */
  DrawnScene draw_scene(unsigned int seed);
} // namespace wall
