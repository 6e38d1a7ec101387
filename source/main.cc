#include "nsfd/compare/compare_command.h"
#include "nsfd/input/command_line.h"
#include "nsfd/input/read_law.h"
#include "nsfd/input/read_scene.h"
#include "nsfd/law_path/run_law.h"
#include "nsfd/mesh/gmsh_process.h"
#include "nsfd/simulation.h"
#include "nsfd/stored/solve_command.h"
#include "nsfd/study/study_command.h"

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <malloc.h>

#include <iostream>
#include <string>

namespace
{
  using namespace nsfd;

  /** The complete file of a scene or a law, or what is wrong with it. */
  int print_parameters(const CommandLine &command)
  {
    InputErrors errors;
    std::string echo;
    if (command.law) {
      if (const auto law = read_law(command.file, command.overrides(), errors))
        echo = law->echo;
    } else if (const auto scene =
                   read_scene(command.file, command.overrides(), errors))
      echo = scene->echo;
    std::cerr << errors.report();
    std::cout << echo;
    return errors.has_errors() ? exit_code::bad_input : exit_code::done;
  }

  /** Without MPI: the cases are processes of their own. */
  int study(const int argc, char **argv)
  {
    StudyCommand command;
    const int skip = argv[1] == std::string("study") ? 1 : 0;
    if (const auto code = parse_study_command_line(
            argc - skip, argv + skip, command, std::cout, std::cerr))
      return *code;
    try {
      return run_study(command, std::cout, std::cerr);
    } catch (const std::exception &error) {
      std::cerr << "nsfd study: " << error.what() << "\n";
      return exit_code::internal_error;
    }
  }

  /** Without MPI: reads files. */
  int compare(const int argc, char **argv)
  {
    CompareCommand command;
    if (const auto code = parse_compare_command_line(
            argc - 1, argv + 1, command, std::cout, std::cerr))
      return *code;
    try {
      return run_compare(command, std::cout, std::cerr);
    } catch (const std::exception &error) {
      std::cerr << "nsfd compare: " << error.what() << "\n";
      return exit_code::internal_error;
    }
  }

  /** One process is enough; all end with its exit code. */
  template <typename Work>
  int run_on_root(const bool root, const Work &work)
  {
    int code = root ? work() : exit_code::done;
    MPI_Bcast(&code, 1, MPI_INT, 0, MPI_COMM_WORLD);
    return code;
  }
} // namespace

int main(int argc, char **argv)
{
  if (const auto code = run_gmsh_if_asked(argc, argv))
    return *code;
  if (asks_for_study(argc, argv))
    return study(argc, argv);
  if (argc > 1 && argv[1] == std::string("compare"))
    return compare(argc, argv);
  // Vectors come and go in every step: their pages stay with the process.
  mallopt(M_MMAP_THRESHOLD, 1 << 28);
  mallopt(M_TRIM_THRESHOLD, 1 << 28);
  CommandLine command;
  SolveCommand stored;
  const bool solve = argc > 1 && argv[1] == std::string("solve");
  if (const auto code =
        solve ? parse_solve_command_line(argc - 1, argv + 1, stored, std::cout,
                                         std::cerr)
              : parse_command_line(argc, argv, command, std::cout, std::cerr))
    return *code;

  // what needs no bodies needs no MPI
  if (command.print_parameters)
    return print_parameters(command);

  dealii::deal_II_exceptions::disable_abort_on_exception();
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const bool root =
    dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  try {
    if (solve)
      return run_on_root(
          root, [&] { return run_solve(stored, std::cout, std::cerr); });
    if (command.law)
      return run_on_root(root, [&] { return run_law(command); });
    InputErrors errors;
    const auto input = read_scene(command.file, command.overrides(), errors);
    if (root)
      std::cerr << errors.report();
    if (!input)
      return exit_code::bad_input;
    RunOptions options;
    for (int i = 0; i < argc; ++i)
      options.command_line += std::string(i ? " " : "") + argv[i];
    options.force = command.force;
    options.quiet = command.quiet;
    options.check = command.check;
    options.resume = command.resume;
    return run_scene(*input, options, MPI_COMM_WORLD);
  } catch (const std::exception &error) {
    std::cerr << "internal error: " << error.what()
              << "\nPlease report it with the parameter file.\n";
    if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
      MPI_Abort(MPI_COMM_WORLD, exit_code::internal_error);
    return exit_code::internal_error;
  }
}
