#pragma once

#include "nsfd/input/command_line.h"

namespace nsfd
{
  /**
   * `nsfd law`: read, drive, write the curve and its pictures, print a table.
   * Serial. @return the exit code
   */
  int run_law(const CommandLine &command);
} // namespace nsfd
