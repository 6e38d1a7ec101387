#pragma once

#include <iosfwd>
#include <optional>
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
   * True if the arguments of main() ask for a study: `study`, or a file with a
   * section `Study`.
   */
  bool asks_for_study(int argc, const char *const *argv);

  /**
   * Parse the arguments after `nsfd study`, or after `nsfd` if the file is a
   * study. Starts no MPI and runs nothing.
   *
   * @return the exit code if the program is done, else nothing
   */
  std::optional<int> parse_study_command_line(int argc, const char *const *argv,
                                              StudyCommand &command,
                                              std::ostream &out,
                                              std::ostream &err);

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
