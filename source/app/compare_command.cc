#include "compare/compare_command.h"

#include "common_options.h"

#include <cmath>
#include <filesystem>
#include <iostream>

namespace nsfd
{
  namespace
  {
    const char *const compare_footer =
        "The first run is compared with each of the others. Results, which the "
        "tolerance\n"
        "is for: energies, dissipated lines, work, reactions, broken area, "
        "fragments,\n"
        "final time, at the end and over time, relative to the largest of "
        "their kind.\n"
        "Exit code: 0 compared, 1 something cannot be read, 6 results differ "
        "by more\n"
        "than T.\n"
        "Example:\n"
        "  nsfd compare output/wedge output/tough --output output/both";

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

    /** Compares the folders of runs. Reads files, needs no MPI. */
    class CompareCommandLine final : public Subcommand
    {
    public:
      void declare(CLI::App &app, CommandLine &line) override
      {
        namespace common = common_options;
        app.footer(compare_footer);
        app.add_option("RUN", command_.runs,
                       "folders of results, or files summary.json; two or "
                       "more")
            ->option_text("RUN RUN ...");
        app.add_option_function<double>(
               "--tolerance",
               [this](const double value) { command_.tolerance = value; },
               "exit code 6 if a result differs by more, relative")
            ->type_name("T");
        common::add_output(app, line,
                           "folder for compare.html, compare.json and the "
                           "diagrams; without it no file is written");
        common::add_force(app, line,
                          "overwrite the results of an earlier comparison");
        common::add_general(app, line);
      }

      void check(CommandLine &line) override
      {
        command_.output = line.output;
        command_.force = line.force;
        command_.quiet = line.quiet;
        if (command_.runs.size() < 2)
          throw WrongUsage("two runs are needed",
                           "write for example: nsfd compare output/a output/b");
        if (command_.tolerance &&
            !(*command_.tolerance >= 0. && std::isfinite(*command_.tolerance)))
          throw WrongUsage("--tolerance must be 0 or more",
                           "write for example: --tolerance 1e-6");
        if (!command_.output.empty() && is_a_run(command_))
          throw WrongUsage("--output " + command_.output +
                               " is one of the runs",
                           "name another folder");
      }

      int execute(const CommandLine &) const override
      {
        return run_compare(command_, std::cout, std::cerr);
      }

    private:
      CompareCommand command_;
    };
  } // namespace

  NamedSubcommand compare_subcommand()
  {
    return {"compare", "what differs between runs", "run",
            "name runs before the options",
            std::make_shared<CompareCommandLine>()};
  }
} // namespace nsfd
