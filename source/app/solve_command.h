#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace nsfd
{
  /** What was asked for: `nsfd solve PROBLEM.hdf5 ...` and its options. */
  struct SolveCommand {
    std::vector<std::string> files; ///< folders have become their files
    std::string solver = "auto";
    double tolerance = 1e-8;
    bool quiet = false; ///< the exit code says it
  };

  /**
   * Read all problems, then solve one after the other: a few lines for one
   * problem, a table for several. Writes no file.
   *
   * @return exit_code::done if all are solved, bad_input if a file holds no
   * problem (then none is solved), step_failed if an error is above the
   * tolerance
   */
  int run_solve(const SolveCommand &command, std::ostream &out,
                std::ostream &err);
} // namespace nsfd
