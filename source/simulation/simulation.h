#pragma once

#include "records/run_options.h"

#include <mpi.h>

namespace nsfd
{
  struct SceneInput;

  /**
   * Build what the scene names, run it, write the output directory. Messages
   * about the input go to standard error. @return one of nsfd::exit_code.
   */
  int run_scene(const SceneInput &input, const RunOptions &options,
                MPI_Comm communicator);
} // namespace nsfd
