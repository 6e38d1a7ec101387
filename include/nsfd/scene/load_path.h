#pragma once

#include "nsfd/scene/scene_input.h"

namespace nsfd
{
  /**
   * `at solution jump = arc length`: follows the path of equilibria, on which
   * the load time is an unknown.
   */
  constexpr SolutionJump along_the_path = SolutionJump(3);

  /** Loads may run backwards. */
  inline bool follows_path(const SceneInput &input)
  {
    return input.statics && input.statics->steps &&
           input.statics->at_jump == along_the_path;
  }
} // namespace nsfd
