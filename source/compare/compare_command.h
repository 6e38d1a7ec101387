#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  /** What was asked for: `nsfd compare A B ...` and its options. */
  struct CompareCommand {
    std::vector<std::string> runs; ///< folders, or summary.json files
    std::string output;            ///< empty: no file is written
    bool force = false;
    std::optional<double> tolerance;
  };

  /**
   * Parse the arguments after `nsfd compare`. Starts no MPI, reads no file.
   *
   * @return the exit code if the program is done, else nothing
   */
  std::optional<int> parse_compare_command_line(int argc,
                                                const char *const *argv,
                                                CompareCommand &command,
                                                std::ostream &out,
                                                std::ostream &err);

  /**
   * Print what differs between the first run and the others; with an output
   * folder also compare.html and compare.json.
   *
   * @return exit_code::done, bad_input if something cannot be read (nothing is
   * written), differs if results differ by more than the tolerance
   */
  int run_compare(const CompareCommand &command, std::ostream &out,
                  std::ostream &err);
} // namespace nsfd
