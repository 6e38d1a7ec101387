#pragma once

#include <mpi.h>

#include <string>

namespace nsfd
{
  struct SceneInput;

  struct RunOptions
  {
    std::string command_line;
    bool force = false, quiet = false, check = false, resume = false;
  };

  /**
   * Build what the scene names, run it, write the output directory. Messages
   * about the input go to standard error. @return one of nsfd::exit_code.
   */
  int run_scene(const SceneInput &input,
                const RunOptions &options,
                MPI_Comm communicator);
} // namespace nsfd
