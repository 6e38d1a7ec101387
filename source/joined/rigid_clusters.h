#pragma once

#include "joined_mesh.h"

namespace nsfd
{
  /**
   * Cells of rigid materials that intact faces join are one rigid body. By
   * corner its number, -1 where a cell deforms; the same numbers on all ranks,
   * whatever the ranks. Collective; @p ghosts of the cells, if there may be
   * some; @p intact by point.
   */
  template <int dim>
  std::vector<int> rigid_clusters(const Discretization<dim> &discretization,
                                  const JoinedMesh<dim> &mesh,
                                  const Communicator &communicator,
                                  const GhostCells *ghosts,
                                  const std::vector<std::uint8_t> &intact);
} // namespace nsfd
