#pragma once

#include "group_report.h"

#include <string>
#include <vector>

namespace nsfd
{
  struct ObstacleInput;

  /**
   * The parts that only scenes with large motions have: finite strain, rigid
   * bodies, the search for contacts, pins. A keyword and a sentence per line.
   * Empty for other scenes.
   */
  std::vector<ReportLine> motion_report(const SceneInput &input);

  /** "plane", "hollow sphere", "moving cylinder". */
  std::string describe_obstacle(const ObstacleInput &obstacle,
                                unsigned int dimension);
} // namespace nsfd
