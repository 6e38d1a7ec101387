#pragma once

#include "core/communicator.h"
#include "nsfd/scene/scene_input.h"

#include <string>
#include <vector>

namespace nsfd
{
  /** Sentences to standard error, as `FILE: KIND: SENTENCE`; rank 0 only. */
  void print_problems(const Communicator &communicator, const SceneInput &input,
                      const char *kind,
                      const std::vector<std::string> &problems);
} // namespace nsfd
