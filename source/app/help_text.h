#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace nsfd
{
  /** Helps for a terminal of 80 columns: usage, options, footer. */
  class HelpText : public CLI::Formatter
  {
  public:
    std::string make_help(const CLI::App *app, std::string name,
                          CLI::AppFormatMode mode) const override;
    std::string make_option(const CLI::Option *option,
                            bool is_positional) const override;
  };

  /** A line per subcommand: how it is written, and what it does. */
  std::string overview(const CLI::App &nsfd);

  /** @p text in lines that end before column 80, the first of them behind
   * @p head and all others below it. */
  std::string wrapped(const std::string &head, const std::string &text,
                      std::size_t indent);
} // namespace nsfd
