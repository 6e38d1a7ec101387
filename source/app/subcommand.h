#pragma once

#include "command_line.h"

#include <CLI/CLI.hpp>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace nsfd
{
  /** A command line that cannot be followed, and what to write instead. */
  class WrongUsage : public std::runtime_error
  {
  public:
    explicit WrongUsage(const std::string &message,
                        const std::string &advice = "")
        : std::runtime_error(message), advice_(advice)
    {
    }
    const std::string &advice() const { return advice_; }

  private:
    std::string advice_;
  };

  /** A branch of the command line: its options, and what it does. */
  class Subcommand
  {
  public:
    virtual ~Subcommand() = default;

    /** Declares options and helps on @p app, its branch of the tree. */
    virtual void declare(CLI::App &app, CommandLine &line) = 0;

    /** After all options are read: what they mean together. Throws WrongUsage.
     */
    virtual void check(CommandLine &line) = 0;

    /** Does it. @return the exit code of the program */
    virtual int execute(const CommandLine &line) const = 0;
  };

  /** A subcommand as the tree knows it. */
  struct NamedSubcommand {
    const char *name, *text; ///< the text is a line of the help
    /// what a word too many is, and what to do about it
    const char *argument, *advice;
    std::shared_ptr<Subcommand> subcommand;
  };

  NamedSubcommand run_subcommand();
  NamedSubcommand study_subcommand();
  NamedSubcommand law_subcommand();
  NamedSubcommand solve_subcommand();
  NamedSubcommand compare_subcommand();
  NamedSubcommand mesh_subcommand();
} // namespace nsfd
