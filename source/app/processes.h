#pragma once

#include "command_line.h"

#include <mpi.h>

#include <exception>
#include <functional>
#include <string>

namespace nsfd
{
  class InputErrors;

  /** As far as is known before MPI has started. */
  bool is_first_process();

  /** Signals end the program in order, exceptions of deal.II are thrown: before
   * a scene is read. */
  void prepare_process();

  /** Starts MPI and does @p work on all ranks. @return its exit code; what it
   * throws is said, and the exit code is internal_error. */
  int run_on_all_processes(const CommandLine &line,
                           const std::function<int(MPI_Comm)> &work);

  /** The same for work of one process; all end with its exit code. */
  int run_on_first_process(const CommandLine &line,
                           const std::function<int()> &work);

  /** Says that the program has failed. @return the exit code */
  int report_failure(const std::exception &error);

  /** The complete file of a scene or a law, or what is wrong with it.
   * @return the exit code */
  int print_parameters(const std::string &echo, const InputErrors &errors);
} // namespace nsfd
