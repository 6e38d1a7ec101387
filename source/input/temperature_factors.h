#pragma once

#include "nsfd/parameters/section_reader.h"
#include "nsfd/scene/interface_input.h"

// Entries of Interface and Obstacle blocks that depend on temperature.

namespace nsfd
{
  struct SceneInput;

  /** What @p friction is times, and by @p sliding no less than. */
  TemperatureFactor read_friction_factor(SectionReader &reader,
                                         const SceneInput &scene,
                                         double friction,
                                         const SlidingInput &sliding);

  /** Of the cohesive law of @p input. */
  void read_law_factors(SectionReader &reader, const SceneInput &scene,
                        InterfaceInput &input);
} // namespace nsfd
