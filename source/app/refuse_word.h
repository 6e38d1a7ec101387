#pragma once

#include "command_line.h"
#include "parameters/input_errors.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <ostream>
#include <string>
#include <vector>

/** Wrong usage of `nsfd` and of its subcommands, said in one way. */
namespace nsfd
{
  inline int refuse(std::ostream &err, const std::string &program,
                    const std::string &message, const std::string &advice)
  {
    err << program << ": " << message << "\n";
    if (!advice.empty())
      err << "  " << advice << "\n";
    return exit_code::wrong_usage;
  }

  /** A word that no option of @p app has taken: an argument too many of the
   * kind @p noun, or an option that does not exist. */
  inline int refuse_word(std::ostream &err, const std::string &program,
                         const std::string &word, const CLI::App &app,
                         const std::string &noun, const std::string &advice)
  {
    const std::string option = word.substr(0, word.find('='));
    if (option.empty() || option[0] != '-')
      return refuse(err, program,
                    fmt::format("`{}` is one {} too many", word, noun), advice);
    std::vector<std::string> known;
    for (const CLI::Option *other : app.get_options())
      for (const std::string &name : other->get_lnames())
        known.push_back("--" + name);
    return refuse(err, program, fmt::format("there is no option `{}`", option),
                  did_you_mean(option, known,
                               "`" + program + " --help` prints them all"));
  }
} // namespace nsfd
