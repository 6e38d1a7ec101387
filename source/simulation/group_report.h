#pragma once

#include <string>
#include <vector>

namespace nsfd
{
  struct SceneInput;

  /**
   * About a mesh that brings groups: shapes, every group with its size and the
   * blocks that name it, what was changed while it was read. A keyword and a
   * sentence per line. Empty for other meshes.
   */
  struct ReportLine {
    std::string keyword, text;
  };
  std::vector<ReportLine> group_report(const SceneInput &input);

  /** The same in few lines, for the log of a run. */
  std::vector<ReportLine> short_group_report(const SceneInput &input);
} // namespace nsfd
