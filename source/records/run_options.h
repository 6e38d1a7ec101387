#pragma once

#include <string>

namespace nsfd
{
  /** What was asked for on the command line of a run. */
  struct RunOptions {
    std::string command_line;
    /// the same for a shell, to go on after a stop
    std::string resume_line;
    bool force = false, quiet = false, check = false, resume = false,
         strict = false, verbose = false;
  };
} // namespace nsfd
