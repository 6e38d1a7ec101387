#pragma once

#include "model.h"

#include "nsfd/output/run_record.h"

namespace nsfd
{
  struct RunOptions;

  /** What a run is: program, machine, command and the parts that were built. */
  template <int dim>
  RunInfo run_info(const SceneInput &input, const RunOptions &options,
                   const Model<dim> &model, unsigned int n_ranks);
} // namespace nsfd
