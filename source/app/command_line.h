#pragma once

#include "core/exit_code.h"

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  /** What was asked for: `nsfd FILE.prm` or `nsfd law NAME`, and options. */
  struct CommandLine {
    bool law = false; ///< `file` is a law, or the file of one
    std::string file;
    std::vector<std::string> set; ///< Section/name=value, as given
    std::string output;           ///< empty: what the file says
    bool force = false;           ///< overwrite the output directory
    bool check = false;           ///< read and build, but do not run
    bool print_parameters = false;
    bool quiet = false;
    bool verbose = false; ///< a line for every step
    bool strict = false;  ///< a certificate that is not ok is a failure
    bool resume = false;  ///< from the last checkpoint of the output directory

    /** What read_scene() takes: --set, and --output as one of them. */
    std::vector<std::string> overrides() const;
  };

  /**
   * Parse the arguments of main(). What is asked for and needs no run (--help,
   * --version, --list) goes to @p out, what is wrong to @p err. Starts no MPI
   * and reads no file.
   *
   * @return the exit code if the program is done, else nothing
   */
  std::optional<int> parse_command_line(int argc, const char *const *argv,
                                        CommandLine &command_line,
                                        std::ostream &out, std::ostream &err);

  /** The same for the arguments after `nsfd law`, see law_command_line.cc. */
  std::optional<int> parse_law_command_line(int argc, const char *const *argv,
                                            CommandLine &command_line,
                                            std::ostream &out,
                                            std::ostream &err);

  /** The names that a parameter file may write, with their texts. */
  void print_list(std::ostream &out);
} // namespace nsfd
