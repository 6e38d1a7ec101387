#include "command_line.h"
#include "compare/compare_command.h"
#include "core/output_folder.h"
#include "core/stop_request.h"
#include "input/read_scene.h"
#include "material_point/read_law.h"
#include "material_point/run_law.h"
#include "mesh/gmsh_process.h"
#include "simulation/simulation.h"
#include "solve_command.h"
#include "study/study_command.h"

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <malloc.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <new>
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
    if (!std::cout.flush())
      return exit_code::internal_error;
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

  /** For a shell: quoted only where it must be. */
  std::string quoted(const std::string &word)
  {
    if (!word.empty() &&
        word.find_first_not_of("abcdefghijklmnopqrstuvwxyz"
                               "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                               "_-./:=,+@%") == std::string::npos)
      return word;
    std::string result = "'";
    for (const char c : word)
      result += c == '\'' ? "'\\''" : std::string(1, c);
    return result + "'";
  }

  /** What goes on with a run of this command. */
  std::string resume_line(const int argc, char **argv, const bool resumes,
                          const unsigned int n_ranks)
  {
    std::string line =
        n_ranks > 1 ? "mpirun -n " + std::to_string(n_ranks) + " " : "";
    for (int i = 0; i < argc; ++i)
      if (argv[i] != std::string("--force"))
        line += (i > 0 ? " " : "") + quoted(argv[i]);
    return resumes ? line : line + " --resume";
  }

  /** As far as is known before MPI has started. */
  bool is_first_process()
  {
    for (const char *rank : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"})
      if (const char *value = std::getenv(rank))
        return value == std::string("0");
    return true;
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
  // `nsfd run FILE.prm` is `nsfd FILE.prm`
  if (argc > 1 && argv[1] == std::string("run")) {
    std::rotate(argv + 1, argv + 2, argv + argc);
    argv[--argc] = nullptr;
  }
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
          solve ? parse_solve_command_line(argc - 1, argv + 1, stored,
                                           std::cout, std::cerr)
                : parse_command_line(argc, argv, command, std::cout, std::cerr))
    return *code;

  // what needs no bodies needs no MPI
  if (command.print_parameters)
    try {
      return print_parameters(command);
    } catch (const std::exception &error) {
      std::cerr << "internal error: " << error.what() << "\n";
      return exit_code::internal_error;
    }

  stop_request::end_at_signals(is_first_process());
  dealii::deal_II_exceptions::disable_abort_on_exception();
  InputErrors errors;
  std::unique_ptr<SceneInput> input;
  if (!solve && !command.law)
    try {
      input = read_scene(command.file, command.overrides(), errors);
      if (is_first_process())
        std::cerr << errors.report();
      if (!input)
        return exit_code::bad_input;
    } catch (const std::exception &error) {
      std::cerr << "internal error: " << error.what()
                << "\nPlease report it with the parameter file.\n";
      return exit_code::internal_error;
    }
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const bool root =
      dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  const unsigned int n_ranks =
      dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  // MPI has taken some of them
  stop_request::end_at_signals(root);
  try {
    if (solve)
      return run_on_root(
          root, [&] { return run_solve(stored, std::cout, std::cerr); });
    if (command.law)
      return run_on_root(root, [&] {
        return run_law({command.file, command.overrides(), command.check,
                        command.quiet, command.force});
      });
    RunOptions options;
    for (int i = 0; i < argc; ++i)
      options.command_line += std::string(i ? " " : "") + argv[i];
    options.force = command.force;
    options.resume_line = resume_line(argc, argv, command.resume, n_ranks);
    options.quiet = command.quiet;
    options.verbose = command.verbose;
    options.strict = command.strict;
    options.check = command.check;
    options.resume = command.resume;
    return run_scene(*input, options, MPI_COMM_WORLD);
  } catch (const OutputError &error) {
    if (root || !error.is_on_all_ranks())
      std::cerr << "error: " << error.what() << "\n";
    if (n_ranks > 1 && !error.is_on_all_ranks())
      MPI_Abort(MPI_COMM_WORLD, exit_code::internal_error);
    return exit_code::internal_error;
  } catch (const std::bad_alloc &) {
    std::cerr << "there is not enough memory left for this\n";
    if (n_ranks > 1)
      MPI_Abort(MPI_COMM_WORLD, exit_code::internal_error);
    return exit_code::internal_error;
  } catch (const std::exception &error) {
    std::cerr << "internal error: " << error.what()
              << "\nPlease report it with the parameter file.\n";
    if (n_ranks > 1)
      MPI_Abort(MPI_COMM_WORLD, exit_code::internal_error);
    return exit_code::internal_error;
  }
}
