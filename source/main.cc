#include "nsfd/input/command_line.h"
#include "nsfd/input/read_scene.h"
#include "nsfd/simulation.h"

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <iostream>

int main(int argc, char **argv)
{
  using namespace nsfd;
  CommandLine command;
  if (const auto code =
        parse_command_line(argc, argv, command, std::cout, std::cerr))
    return *code;

  // what needs no bodies needs no MPI
  if (command.print_parameters) {
    InputErrors errors;
    const auto input = read_scene(command.file, command.overrides(), errors);
    std::cerr << errors.report();
    if (!input)
      return exit_code::bad_input;
    std::cout << input->echo;
    return exit_code::done;
  }

  dealii::deal_II_exceptions::disable_abort_on_exception();
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const bool root =
    dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  try {
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
    return run_scene(*input, options, MPI_COMM_WORLD);
  } catch (const std::exception &error) {
    std::cerr << "internal error: " << error.what()
              << "\nPlease report it with the parameter file.\n";
    if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
      MPI_Abort(MPI_COMM_WORLD, exit_code::internal_error);
    return exit_code::internal_error;
  }
}
