#include "compare/compare_command.h"

#include "refuse_word.h"

#include <CLI/CLI.hpp>

#include <cmath>
#include <filesystem>
#include <ostream>

namespace nsfd
{
  namespace
  {
    const char *const footer =
        "The first run is compared with each of the others. Results, which the "
        "tolerance is for:\n"
        "energies, dissipated lines, work, reactions, broken area, fragments, "
        "final time, at the\n"
        "end and over time, relative to the largest of their kind.\n"
        "Exit code: 0 compared, 1 something cannot be read, 6 results differ "
        "by more than T.\n"
        "Example:\n"
        "  nsfd compare output/wedge output/tough --output "
        "output/wedge_and_tough\n";

    /** What --force would take away is one of the runs. */
    bool is_a_run(const CompareCommand &command)
    {
      namespace fs = std::filesystem;
      std::error_code error;
      for (const fs::path run : command.runs)
        if (fs::equivalent(
                fs::is_directory(run, error) ? run : run.parent_path() / ".",
                command.output, error))
          return true;
      return false;
    }
  } // namespace

  std::optional<int> parse_compare_command_line(const int argc,
                                                const char *const *argv,
                                                CompareCommand &command,
                                                std::ostream &out,
                                                std::ostream &err)
  {
    CLI::App app("Compare runs: their parameters, numbers, certificates and "
                 "curves over time.",
                 "nsfd compare");
    app.set_help_flag();
    app.allow_extras();
    app.footer(footer);
    bool help = false;
    double tolerance = 0.;
    app.add_option("RUN", command.runs,
                   "folders of results, or files summary.json; two or more");
    auto *given =
        app.add_option("--tolerance", tolerance,
                       "exit code 6 if a result differs by more, relative")
            ->type_name("T");
    app.add_option("--output", command.output,
                   "folder for compare.html, compare.json and the diagrams; "
                   "without it no file is written")
        ->type_name("DIR");
    app.add_flag("--force", command.force,
                 "overwrite the results of an earlier comparison");
    app.add_flag("--help", help, "print this help");
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError &error) {
      return refuse(err, "nsfd compare", error.what(),
                    "`nsfd compare --help` prints all options");
    }
    const std::vector<std::string> extras = app.remaining();
    if (!extras.empty())
      return refuse_word(err, "nsfd compare", extras.front(), app, "run",
                         "name runs before the options");
    if (help) {
      out << app.help();
      return exit_code::done;
    }
    if (command.runs.size() < 2)
      return refuse(err, "nsfd compare", "two runs are needed",
                    "write for example: nsfd compare output/a output/b");
    if (given->count() > 0) {
      if (!(tolerance >= 0.) || !std::isfinite(tolerance))
        return refuse(err, "nsfd compare", "--tolerance must be 0 or more",
                      "write for example: --tolerance 1e-6");
      command.tolerance = tolerance;
    }
    if (!command.output.empty() && is_a_run(command))
      return refuse(err, "nsfd compare",
                    "--output " + command.output + " is one of the runs",
                    "name another folder");
    return {};
  }
} // namespace nsfd
