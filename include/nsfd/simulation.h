#pragma once

#include <mpi.h>

#include <string>

namespace nsfd
{
  struct SceneInput;

  struct RunOptions
  {
    std::string command_line;
    /// the same for a shell, to go on after a stop
    std::string resume_line;
    bool force = false, quiet = false, check = false, resume = false,
         strict = false, verbose = false;
  };

  /**
   * Build what the scene names, run it, write the output directory. Messages
   * about the input go to standard error. @return one of nsfd::exit_code.
   */
  int run_scene(const SceneInput &input,
                const RunOptions &options,
                MPI_Comm communicator);
} // namespace nsfd
