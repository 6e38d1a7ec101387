#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace nsfd
{
  /** What was asked for: `nsfd study FILE.prm` and its options. */
  struct StudyCommand {
    std::string file;
    std::vector<std::string> set, vary;
    bool force = false, resume = false, check = false, quiet = false,
         print_parameters = false;
    std::string command_line; ///< all of it, for the record
  };

  /**
   * Check all combinations, run each in processes of its own, write tables and
   * diagrams.
   *
   * @return exit_code::done if all are done; bad_input if a combination cannot
   * be run (then none is, if that shows before), step_failed if one could not
   * be solved, internal_error if one broke, stopped on a signal
   */
  int run_study(const StudyCommand &command, std::ostream &out,
                std::ostream &err);
} // namespace nsfd
