#include "command_line.h"
#include "material_point/path.h"
#include "parameters/input_errors.h"
#include "refuse_word.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <ostream>

namespace nsfd
{
  namespace
  {
    /** Arguments that no option has taken. */
    int fail_at(std::ostream &err, const std::string &word, const CLI::App &app)
    {
      return refuse_word(
          err, "nsfd law", word, app, "law",
          "drive one law at a time, or write a file with several "
          "Interface blocks");
    }

    std::string paths_text()
    {
      std::string text = "Paths:\n";
      for (const NamedPath &path : named_paths())
        text += fmt::format("  {:<14}{}\n", path.name, path.text);
      text += "  FILE.csv      marks: a header opening,slip,reaction and SI "
              "numbers\n"
              "Examples:\n"
              "  nsfd law tvergaard\n"
              "  nsfd law michel-suquet --path 'shear cycle' --set "
              "friction=0.3\n"
              "  nsfd law camacho-ortiz --set 'strength=5 MPa' --opening '0, "
              "1 um, 0, 3 um'\n";
      return text;
    }

    bool ends_with(const std::string &text, const std::string &end)
    {
      return text.size() >= end.size() &&
             text.compare(text.size() - end.size(), end.size(), end) == 0;
    }
  } // namespace

  std::optional<int> parse_law_command_line(const int argc,
                                            const char *const *argv,
                                            CommandLine &command_line,
                                            std::ostream &out,
                                            std::ostream &err)
  {
    CLI::App app("Drive one interface point along a path; write its curve and "
                 "energies.",
                 "nsfd law");
    app.set_help_flag();
    app.allow_extras();
    app.footer(paths_text());
    bool help = false;
    std::string path, steps, rule;
    std::string opening, slip, reaction;
    app.add_option("NAME", command_line.file,
                   "a cohesive law of --list, with its example; or FILE.prm "
                   "with Interface blocks and a section Path or Bar");
    app.add_option_function<std::vector<std::string>>(
           "--set",
           [&](const std::vector<std::string> &values) {
             command_line.set = values;
           },
           "'name=value', an entry of the law, friction or friction exponent; "
           "'Section/name=value', any other; repeatable")
        ->type_size(1)
        ->allow_extra_args(false)
        ->type_name("TEXT");
    const auto text_option = [&](const char *name, std::string &target,
                                 const char *text, const char *type) {
      app.add_option(name, target, text)->type_name(type);
    };
    text_option("--path", path, "where it goes, see below; default opening",
                "NAME");
    text_option("--opening", opening, "u_N at the marks of a path, with commas",
                "LIST");
    text_option("--slip", slip, "u_T at the marks of a path", "LIST");
    text_option("--reaction", reaction,
                "contact traction: at the marks, or of a named path", "LIST");
    text_option("--steps", steps, "of the whole path, default 400", "N");
    text_option("--rule", rule,
                "cohesion rule: end point (default), end velocity or exact",
                "NAME");
    text_option("--output", command_line.output,
                "folder for the results, default output/law_NAME", "DIR");
    app.add_flag("--force", command_line.force,
                 "overwrite the results of an earlier run");
    app.add_flag("--check", command_line.check,
                 "say whether it would run, do not run it");
    app.add_flag("--print-parameters", command_line.print_parameters,
                 "print it as a complete file");
    app.add_flag("--quiet", command_line.quiet, "print errors only");
    app.add_flag("--help", help, "print this help");

    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError &error) {
      return refuse(err, "nsfd law", error.what(),
                    "`nsfd law --help` prints all options");
    }
    const std::vector<std::string> extras = app.remaining();
    if (!extras.empty())
      return fail_at(err, extras.front(), app);
    if (help) {
      out << app.help();
      return exit_code::done;
    }
    for (const std::string &assignment : command_line.set)
      if (assignment.find('=') == std::string::npos)
        return refuse(err, "nsfd law",
                      fmt::format("--set {}: there is no `=`", assignment),
                      "write for example: --set 'friction=0.5'");
    if (command_line.file.empty())
      return refuse(err, "nsfd law", "no law is named",
                    "write for example: nsfd law tvergaard");

    if (path.empty() && !(opening.empty() && slip.empty()))
      path = "points";
    if (ends_with(path, ".csv"))
      command_line.set.push_back("Path/file=" + path);
    const std::pair<const char *, std::string> entries[] = {
        {"type", ends_with(path, ".csv") ? "file" : path},
        {"opening", opening},
        {"slip", slip},
        {"reaction", reaction},
        {"steps", steps},
        {"cohesion rule", rule}};
    for (const auto &[name, value] : entries)
      if (!value.empty())
        command_line.set.push_back(fmt::format("Path/{}={}", name, value));
    command_line.law = true;
    return {};
  }
} // namespace nsfd
