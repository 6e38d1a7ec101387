#pragma once

#include "model.h"

#include "nsfd/records/run_record.h"

namespace nsfd
{
  struct RunOptions;

  /** What a run is: program, machine, command and the parts that were built. */
  template <int dim>
  RunInfo run_info(const SceneInput &input, const RunOptions &options,
                   const Model<dim> &model, unsigned int n_ranks);

  /** Points with a cohesive law and with friction, among the counters. */
  template <int dim>
  void count_points(const SceneInput &input,
                    const Discretization<dim> &discretization,
                    const Communicator &communicator,
                    std::map<std::string, double> &counters);

  /** The first lines of a run; @p crossing 0 if there is none. */
  void print_opening(const SceneInput &input, const RunInfo &info,
                     const Summary &summary, double step, double crossing);
} // namespace nsfd
