#pragma once

#include <filesystem>
#include <string>

namespace wall
{
  /** What became of a scene. */
  struct Verdict {
    bool through = true;
    bool refused = false; ///< as wrong input
    bool silent = false;  ///< the run itself calls it good
    double worst = 0.;    ///< to compare failures: how far beyond its bound
    std::string message;
  };

  struct Ended {
    int exit_code = 0; ///< 128 + signal if one ended it
    double cpu_seconds = 0.;
  };

  /**
   * Reads what a run has written: exit code 0, every energy that was given
   * within its bound, no overlap beyond its bound, and momentum as at the start
   * where nothing outside acts.
   */
  Verdict judge(const std::filesystem::path &output,
                const std::filesystem::path &log, const Ended &ended,
                bool keeps_momentum, double end);
} // namespace wall
