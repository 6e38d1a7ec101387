#pragma once

#include "nsfd/parameters/section_reader.h"
#include "nsfd/scene/interface_input.h"

#include <string>
#include <vector>

// Entries of cohesive laws that Interface and Obstacle blocks have in common.

namespace nsfd
{
  struct SceneInput;

  /** Entries that all cohesive laws have, and only they. */
  const std::vector<std::string> &cohesive_entries();

  /** The law that InterfaceInput::law_name names, and what only cohesive laws
      have besides it. */
  void read_cohesive_block(SectionReader &reader, const SceneInput &scene,
                           InterfaceInput &input);

  /** Friction while it is damaged, and what is broken at the start. */
  void read_damage_start(SectionReader &reader, InterfaceInput &input);

  /** A law that adds openings is closed at the opening 0: nothing may move that
      place. */
  void check_lift(SectionReader &reader, const InterfaceInput &input);
} // namespace nsfd
