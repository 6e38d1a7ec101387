#include "command_line.h"
#include "nonsmooth/solvers/contact_solvers.h"
#include "parameters/input_errors.h"
#include "refuse_word.h"
#include "solve_command.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <ostream>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;

    std::string solvers_text()
    {
      std::string text = "Solvers:\n";
      for (const auto &[name, line] : contact_solvers())
        text += fmt::format("  {:<20}{}\n", name, line);
      return text + "Exit code: 0 all solved, 3 one is not, 1 a file holds no "
                    "problem (none is solved).\n"
                    "Example:\n"
                    "  nsfd solve tests/problems\n";
    }

    /** The problems of a folder in the order of their names. */
    std::vector<std::string> files_of(const fs::path &folder)
    {
      std::vector<std::string> files;
      std::error_code error;
      for (const auto &entry : fs::directory_iterator(folder, error)) {
        const std::string end = entry.path().extension().string();
        if (end == ".hdf5" || end == ".h5")
          files.push_back(entry.path().string());
      }
      std::sort(files.begin(), files.end());
      return files;
    }
  } // namespace

  std::optional<int> parse_solve_command_line(const int argc,
                                              const char *const *argv,
                                              SolveCommand &command,
                                              std::ostream &out,
                                              std::ostream &err)
  {
    CLI::App app("Solve stored problems of Coulomb friction (HDF5, layout of "
                 "FCLIB); print residual, iterations and CPU time.",
                 "nsfd solve");
    app.set_help_flag();
    app.allow_extras();
    app.footer(solvers_text());
    bool help = false;
    std::vector<std::string> names;
    app.add_option("PROBLEM.hdf5", names,
                   "problems, or folders of *.hdf5 and *.h5");
    app.add_option("--solver", command.solver, "see below; default auto")
        ->type_name("NAME");
    app.add_option("--tolerance", command.tolerance,
                   "of the relative natural map, default 1e-8")
        ->type_name("T");
    app.add_flag("--help", help, "print this help");
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError &error) {
      return refuse(err, "nsfd solve", error.what(),
                    "`nsfd solve --help` prints all options");
    }
    const std::vector<std::string> extras = app.remaining();
    if (!extras.empty())
      return refuse_word(err, "nsfd solve", extras.front(), app, "problem", "");
    if (help) {
      out << app.help();
      return exit_code::done;
    }
    if (names.empty())
      return refuse(err, "nsfd solve", "no problem is named",
                    "write for example: nsfd solve tests/problems");
    std::vector<std::string> solvers;
    for (const auto &solver : contact_solvers())
      solvers.push_back(solver.first);
    if (std::find(solvers.begin(), solvers.end(), command.solver) ==
        solvers.end())
      return refuse(err, "nsfd solve",
                    fmt::format("there is no solver `{}`", command.solver),
                    did_you_mean(command.solver, solvers,
                                 "`nsfd solve --help` prints them all"));
    if (!(command.tolerance > 0. && command.tolerance < 1.))
      return refuse(err, "nsfd solve",
                    fmt::format("--tolerance is {}", command.tolerance),
                    "write a number between 0 and 1, for example 1e-8");
    for (const std::string &name : names) {
      if (!fs::is_directory(name)) {
        command.files.push_back(name);
        continue;
      }
      const std::vector<std::string> files = files_of(name);
      if (files.empty())
        return refuse(err, "nsfd solve",
                      fmt::format("the folder {} has no problem", name),
                      "its problems must end in .hdf5 or .h5");
      command.files.insert(command.files.end(), files.begin(), files.end());
    }
    return {};
  }
} // namespace nsfd
