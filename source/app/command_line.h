#pragma once

#include "core/exit_code.h"

#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  class Subcommand;

  /**
   * What was asked for: `nsfd [run|study|law|solve|compare|mesh] ...`. Options
   * that several subcommands have stand here, see common_options.h; those of
   * one alone stand in it.
   */
  struct CommandLine {
    std::vector<std::string> words; ///< all of it, the program first
    std::string program = "nsfd";   ///< as messages name it: `nsfd law`

    std::string file;                  ///< a scene, or the name of a law
    std::vector<std::string> set;      ///< Section/name=value, as given
    std::vector<std::string> plug_ins; ///< files of --plug-in
    std::string output;                ///< empty: what the file says
    bool resume = false;               ///< from what is in the output directory
    std::string resume_folder;         ///< what follows --resume
    bool force = false;                ///< overwrite the output directory
    bool check = false;                ///< read and build, but do not run
    bool print_parameters = false;
    bool quiet = false;
    bool verbose = false; ///< a line for every step
    bool strict = false;  ///< a certificate that is not ok is a failure

    std::shared_ptr<Subcommand> subcommand; ///< what is to be done

    /** What read_scene() takes: --set, and --output as one of them. */
    std::vector<std::string> overrides() const;

    /** As one line. */
    std::string text() const;
  };

  /**
   * Parse the arguments of main(): one tree of subcommands. A first word that
   * is a file is `run`, or `study` if the file has a section of that name. What
   * is asked for and needs no run (--help, --version, --list) goes to @p out,
   * what is wrong to @p err. Starts no MPI.
   *
   * @return the exit code if the program is done, else nothing
   */
  std::optional<int> parse_command_line(int argc, const char *const *argv,
                                        CommandLine &line, std::ostream &out,
                                        std::ostream &err);
} // namespace nsfd
