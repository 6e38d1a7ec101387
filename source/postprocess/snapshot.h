#pragma once

#include "field_grids.h"

#include "nsfd/records/run_record.h"

namespace nsfd
{
  /**
   * A picture's worth of data, the same for any number of ranks; empty except
   * on rank 0. Collective.
   */
  template <int dim>
  Snapshot take_snapshot(const Discretization<dim> &discretization,
                         const Communicator &communicator,
                         const FaceNumbers &face_numbers, const State &state,
                         const Fragments<dim> &fragments);
} // namespace nsfd
