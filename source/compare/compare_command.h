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
    bool force = false, quiet = false;
    std::optional<double> tolerance;
  };

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
