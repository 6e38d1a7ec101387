#include "common_options.h"
#include "help_text.h"
#include "input/read_scene.h"
#include "material_point/path.h"
#include "material_point/read_law.h"
#include "material_point/run_law.h"
#include "parameters/input_errors.h"
#include "processes.h"

#include <fmt/format.h>

namespace nsfd
{
  namespace
  {
    std::string paths_text()
    {
      std::string text = "Paths:\n";
      for (const NamedPath &path : named_paths())
        text += wrapped(fmt::format("  {:<14}", path.name), path.text, 16);
      text += "  FILE.csv      marks: a header opening,slip,reaction and SI "
              "numbers\n"
              "Examples:\n"
              "  nsfd law tvergaard\n"
              "  nsfd law michel-suquet --path 'shear cycle' --set "
              "friction=0.3\n"
              "  nsfd law camacho-ortiz --set 'strength=5 MPa' --opening '0, "
              "1 um, 0, 3 um'";
      return text;
    }

    bool ends_with(const std::string &text, const std::string &end)
    {
      return text.size() >= end.size() &&
             text.compare(text.size() - end.size(), end.size(), end) == 0;
    }

    /** Drives the material point of a cohesive law. */
    class LawCommandLine final : public Subcommand
    {
    public:
      void declare(CLI::App &app, CommandLine &line) override
      {
        namespace common = common_options;
        app.footer(paths_text());
        common::add_file(app, line, "NAME",
                         "a cohesive law of --list, with its example; or "
                         "FILE.prm with Interface blocks and a section Path or "
                         "Bar");
        const auto add = [&app](const char *name, std::string &target,
                                const char *text, const char *type) {
          app.add_option(name, target, text)->type_name(type);
        };
        add("--path", path_, "where it goes, see below; default opening",
            "NAME");
        add("--opening", opening_, "u_N at the marks of a path, with commas",
            "LIST");
        add("--slip", slip_, "u_T at the marks of a path", "LIST");
        add("--reaction", reaction_,
            "contact traction: at the marks, or of a named path", "LIST");
        add("--steps", steps_, "of the whole path, default 400", "N");
        add("--rule", rule_,
            "cohesion rule: end point (default), end velocity or exact",
            "NAME");
        common::add_set(app, line,
                        "'name=value', an entry of the law, friction or "
                        "friction exponent; 'Section/name=value', any other",
                        "friction=0.5");
        common::add_output(app, line,
                           "folder for the results, default output/law_NAME");
        common::add_force(app, line, "overwrite the results of an earlier run");
        common::add_check(app, line, "say whether it would run, do not run it");
        app.add_flag("--contract", contract_,
                     "try what every law must keep, on all its examples; exit "
                     "code 1 if it does not");
        common::add_print_parameters(app, line, "print it as a complete file");
        common::add_general(app, line);
      }

      void check(CommandLine &line) override
      {
        if (line.file.empty())
          throw WrongUsage("no law is named",
                           "write for example: nsfd law tvergaard");
        const bool has_marks = !opening_.empty() || !slip_.empty();
        const bool is_table = ends_with(path_, ".csv");
        if (is_table)
          line.set.push_back("Path/file=" + path_);
        const std::pair<const char *, std::string> entries[] = {
            {"type", is_table                     ? "file"
                     : path_.empty() && has_marks ? "points"
                                                  : path_},
            {"opening", opening_},
            {"slip", slip_},
            {"reaction", reaction_},
            {"steps", steps_},
            {"cohesion rule", rule_}};
        for (const auto &[name, value] : entries)
          if (!value.empty())
            line.set.push_back(fmt::format("Path/{}={}", name, value));
      }

      int execute(const CommandLine &line) const override
      {
        if (line.print_parameters) {
          InputErrors errors;
          const auto law = read_law(line.file, line.overrides(), errors);
          return print_parameters(law ? law->echo : "", errors);
        }
        return run_on_first_process(line, [&line, this] {
          return run_law({line.file, line.overrides(), line.check, line.quiet,
                          line.force, contract_});
        });
      }

    private:
      std::string path_, opening_, slip_, reaction_, steps_, rule_;
      bool contract_ = false;
    };
  } // namespace

  NamedSubcommand law_subcommand()
  {
    return {"law", "drive one point of a cohesive law along a path", "law",
            "drive one law at a time, or write a file with several Interface "
            "blocks",
            std::make_shared<LawCommandLine>()};
  }
} // namespace nsfd
