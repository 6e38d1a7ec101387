#include "solve_command.h"

#include "common_options.h"
#include "help_text.h"
#include "nonsmooth/solvers/contact_solvers.h"
#include "parameters/input_errors.h"
#include "processes.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>

namespace nsfd
{
  namespace
  {
    namespace fs = std::filesystem;

    std::string solvers_text()
    {
      std::string text = "Solvers:\n";
      for (const auto &[name, line] : contact_solvers())
        text += wrapped(fmt::format("  {:<20}", name), line, 22);
      return text + "Exit code: 0 all solved, 3 one is not, 1 a file holds no "
                    "problem or an\n"
                    "answer would meet a file (none is solved).\n"
                    "Example:\n"
                    "  nsfd solve tests/problems";
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

    /** Solves problems that are stored in files. */
    class SolveCommandLine final : public Subcommand
    {
    public:
      void declare(CLI::App &app, CommandLine &line) override
      {
        app.footer(solvers_text());
        app.add_option("PROBLEM.hdf5", names_,
                       "problems of Coulomb friction (HDF5, layout of FCLIB), "
                       "or folders of *.hdf5 and *.h5")
            ->option_text("PROBLEM.hdf5 ...");
        app.add_option("--solver", command_.solver, "see below; default auto")
            ->type_name("NAME");
        app.add_option("--tolerance", command_.tolerance,
                       "of the relative natural map, default 1e-8")
            ->type_name("T");
        app.add_option("--attempts", command_.attempts,
                       "of auto for one problem, restarts included, default "
                       "1000; they also end with a fixed amount of work, "
                       "about 10 s of CPU, and the best answer of all counts")
            ->type_name("N");
        app.add_option("--write", command_.folder,
                       "write a copy of every problem with its reactions and "
                       "velocities (group `solution`: r, u) under the same "
                       "name to this folder, never over a file")
            ->type_name("FOLDER");
        common_options::add_general(app, line);
      }

      void check(CommandLine &line) override
      {
        command_.quiet = line.quiet;
        if (names_.empty())
          throw WrongUsage("no problem is named",
                           "write for example: nsfd solve tests/problems");
        std::vector<std::string> solvers;
        for (const auto &solver : contact_solvers())
          solvers.push_back(solver.first);
        if (std::find(solvers.begin(), solvers.end(), command_.solver) ==
            solvers.end())
          throw WrongUsage(
              fmt::format("there is no solver `{}`", command_.solver),
              did_you_mean(command_.solver, solvers,
                           "`nsfd solve --help` prints them all"));
        if (!(command_.tolerance > 0. && command_.tolerance < 1.))
          throw WrongUsage(fmt::format("--tolerance is {}", command_.tolerance),
                           "write a number between 0 and 1, for example 1e-8");
        if (command_.attempts == 0)
          throw WrongUsage("--attempts is 0", "write a number from 1");
        for (const std::string &name : names_) {
          if (!fs::is_directory(name)) {
            command_.files.push_back(name);
            continue;
          }
          const std::vector<std::string> files = files_of(name);
          if (files.empty())
            throw WrongUsage(fmt::format("the folder {} has no problem", name),
                             "its problems must end in .hdf5 or .h5");
          command_.files.insert(command_.files.end(), files.begin(),
                                files.end());
        }
      }

      int execute(const CommandLine &line) const override
      {
        return run_on_first_process(
            line, [this] { return run_solve(command_, std::cout, std::cerr); });
      }

    private:
      std::vector<std::string> names_;
      SolveCommand command_;
    };
  } // namespace

  NamedSubcommand solve_subcommand()
  {
    return {"solve", "solve stored contact problems", "problem", "",
            std::make_shared<SolveCommandLine>()};
  }
} // namespace nsfd
