#include "processes.h"

#include "core/output_folder.h"
#include "core/stop_request.h"
#include "parameters/input_errors.h"

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <cstdlib>
#include <iostream>
#include <new>
#include <vector>

namespace nsfd
{
  bool is_first_process()
  {
    for (const char *rank : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"})
      if (const char *value = std::getenv(rank))
        return value == std::string("0");
    return true;
  }

  void prepare_process()
  {
    stop_request::end_at_signals(is_first_process());
    dealii::deal_II_exceptions::disable_abort_on_exception();
  }

  int run_on_all_processes(const CommandLine &line,
                           const std::function<int(MPI_Comm)> &work)
  {
    std::vector<std::string> words = line.words;
    std::vector<char *> pointers;
    for (std::string &word : words)
      pointers.push_back(word.data());
    pointers.push_back(nullptr);
    int argc = words.size();
    char **argv = pointers.data();
    // a rank that waits lets others run: where cores have other work, too, each
    // exchange costs a slice of the scheduler otherwise
    setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0);
    dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
    const bool root =
        dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
    const bool several =
        dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1;
    // MPI has taken some of them
    stop_request::end_at_signals(root);
    try {
      return work(MPI_COMM_WORLD);
    } catch (const OutputError &error) {
      if (root || !error.is_on_all_ranks())
        std::cerr << "error: " << error.what() << "\n";
      if (several && !error.is_on_all_ranks())
        MPI_Abort(MPI_COMM_WORLD, exit_code::internal_error);
    } catch (const std::bad_alloc &) {
      std::cerr << "there is not enough memory left for this\n";
      if (several)
        MPI_Abort(MPI_COMM_WORLD, exit_code::internal_error);
    } catch (const std::exception &error) {
      report_failure(error);
      if (several)
        MPI_Abort(MPI_COMM_WORLD, exit_code::internal_error);
    }
    return exit_code::internal_error;
  }

  int run_on_first_process(const CommandLine &line,
                           const std::function<int()> &work)
  {
    prepare_process();
    return run_on_all_processes(line, [&work](const MPI_Comm communicator) {
      int code = exit_code::done;
      if (dealii::Utilities::MPI::this_mpi_process(communicator) == 0)
        code = work();
      MPI_Bcast(&code, 1, MPI_INT, 0, communicator);
      return code;
    });
  }

  int report_failure(const std::exception &error)
  {
    std::cerr << "internal error: " << error.what()
              << "\nPlease report it with the parameter file.\n";
    return exit_code::internal_error;
  }

  int print_parameters(const std::string &echo, const InputErrors &errors)
  {
    std::cerr << errors.report();
    std::cout << echo;
    if (!std::cout.flush())
      return exit_code::internal_error;
    return errors.has_errors() ? exit_code::bad_input : exit_code::done;
  }
} // namespace nsfd
