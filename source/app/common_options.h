#pragma once

#include "subcommand.h"

#include <string>

/**
 * Options that several subcommands have: each is declared here, once. A
 * subcommand takes those that mean something to it; @p text, where there is
 * one, says what that is.
 */
namespace nsfd::common_options
{
  /** --quiet, --plug-in and --help: for all subcommands. */
  void add_general(CLI::App &app, CommandLine &line);

  /** The word behind the subcommand: @p name as the help shows it. */
  void add_file(CLI::App &app, CommandLine &line, const std::string &name,
                const std::string &text);

  /** --set; @p example is shown where `=` is missing. */
  void add_set(CLI::App &app, CommandLine &line, const std::string &text,
               const std::string &example);

  /** An option that takes one assignment and may be given several times. */
  void add_assignments(CLI::App &app, const std::string &name,
                       std::vector<std::string> &target,
                       const std::string &text, const std::string &example);

  void add_output(CLI::App &app, CommandLine &line, const std::string &text);
  void add_resume(CLI::App &app, CommandLine &line, const std::string &text);
  void add_force(CLI::App &app, CommandLine &line, const std::string &text);
  void add_check(CLI::App &app, CommandLine &line, const std::string &text);
  void add_print_parameters(CLI::App &app, CommandLine &line,
                            const std::string &text);
  void add_verbose(CLI::App &app, CommandLine &line);
  void add_strict(CLI::App &app, CommandLine &line, const std::string &text);

  /** What they mean together. Throws WrongUsage. */
  void check(CommandLine &line);

  /** Load what NSFD_PLUG_INS and --plug-in name. Throws PlugInError. */
  void load_plug_ins(const CommandLine &line);
} // namespace nsfd::common_options
