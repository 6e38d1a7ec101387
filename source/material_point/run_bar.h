#pragma once

#include "read_law.h"

namespace nsfd
{
  /** Pull the points with a bar; write and print what it did. */
  void run_bar(const LawInput &input, bool quiet);
} // namespace nsfd
