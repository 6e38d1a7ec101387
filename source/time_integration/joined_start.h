#pragma once

#include "prescribed_groups.h"

#include "joined/hanging_nodes.h"
#include "state/state.h"

#include <cstdint>
#include <vector>

namespace nsfd
{
  /** By point: joined before anything has let go. */
  template <int dim>
  std::vector<std::uint8_t>
  joined_points(const Discretization<dim> &discretization, const State &state);

  /**
   * That what joins cells of two sizes lasts in a run from @p state.
   * @throws std::runtime_error with a sentence for the user, on all ranks.
   */
  template <int dim>
  void check_hanging(const Communicator &communicator,
                     const Discretization<dim> &discretization,
                     const JoinedMesh<dim> &mesh, const State &state,
                     HangingNodes<dim> &hanging,
                     PrescribedGroups<dim> &supports);
} // namespace nsfd
