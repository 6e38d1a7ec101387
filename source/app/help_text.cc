#include "help_text.h"

#include <sstream>

namespace nsfd
{
  namespace
  {
    constexpr std::size_t width = 79, option_column = 24, usage_column = 30;

    /** FILE.prm, as the usage shows it. */
    std::string positional(const CLI::App &app)
    {
      for (const CLI::Option *option : app.get_options())
        if (option->get_positional())
          return option->get_option_text().empty() ? option->get_name(true)
                                                   : option->get_option_text();
      return "";
    }

    std::vector<const CLI::Option *> in_group(const CLI::App &app,
                                              const std::string &group)
    {
      return app.get_options([&group](const CLI::Option *option) {
        return option->nonpositional() && option->get_group() == group;
      });
    }
  } // namespace

  std::string wrapped(const std::string &head, const std::string &text,
                      const std::size_t indent)
  {
    const std::string next_line = "\n" + std::string(indent, ' ');
    std::string result = head;
    if (head.size() >= indent && !head.empty())
      result += next_line;
    else
      result.append(indent - head.size(), ' ');
    std::size_t column = indent;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
      if (column > indent && column + 1 + word.size() > width) {
        result += next_line;
        column = indent;
      }
      if (column > indent)
        result += " ";
      result += word;
      column += (column > indent) + word.size();
    }
    return result + "\n";
  }

  std::string overview(const CLI::App &nsfd)
  {
    std::string text;
    for (const CLI::App *sub : nsfd.get_subcommands(nullptr)) {
      // the word `run` may be left out
      const std::string word =
          sub->get_name() == "run" ? "" : sub->get_name() + " ";
      text += wrapped("  nsfd " + word + positional(*sub),
                      sub->get_description(), usage_column);
    }
    return text;
  }

  std::string HelpText::make_option(const CLI::Option *option,
                                    const bool is_positional) const
  {
    const bool has_value = option->get_items_expected_max() > 0;
    std::string head =
        "  " + (is_positional
                    ? option->get_name(true)
                    : option->get_name(false, true) +
                          (has_value ? " " + option->get_type_name() : ""));
    return wrapped(head, option->get_description(), option_column);
  }

  std::string HelpText::make_help(const CLI::App *app, const std::string name,
                                  const CLI::AppFormatMode) const
  {
    const std::vector<const CLI::Option *> arguments = app->get_options(
        [](const CLI::Option *option) { return option->get_positional(); });
    if (app->get_parent() != nullptr)
      return wrapped("", name + ": " + app->get_description(), 0) +
             "\nUsage: " + name + " " + positional(*app) + " [OPTIONS]\n" +
             make_group("Arguments", true, arguments) +
             make_group("Options", false, in_group(*app, "Options")) +
             make_group("Information", false, in_group(*app, "Information")) +
             "\n" + make_footer(app);
    // the options of `run`, which needs no word, belong to the first help
    const CLI::App *run = app->get_subcommand("run");
    return wrapped("", app->get_description(), 0) + "\nUsage:\n" +
           overview(*app) +
           make_group("Options", false, in_group(*run, "Options")) +
           make_group("Information", false, in_group(*app, "Information")) +
           "\n" + make_footer(app);
  }
} // namespace nsfd
