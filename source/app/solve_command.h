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
    unsigned int attempts = 1000; ///< of `auto`, restarts included
    std::string folder; ///< for reactions and velocities; empty: not written
    bool quiet = false; ///< the exit code says it
  };

  /**
   * Read all problems, then solve one after the other: a few lines for one
   * problem, a table for several. Writes files in the named folder only, each
   * a problem with its answer, solved or not, and none over another.
   *
   * @return exit_code::done if all are solved, bad_input if a file holds no
   * problem or an answer would meet a file (then none is solved), step_failed
   * if an error is above the tolerance
   * @throws OutputError if an answer cannot be written
   */
  int run_solve(const SolveCommand &command, std::ostream &out,
                std::ostream &err);
} // namespace nsfd
