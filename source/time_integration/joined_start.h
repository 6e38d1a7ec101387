#pragma once

#include "prescribed_groups.h"

#include "joined/hanging_nodes.h"
#include "state/state.h"

#include <cstdint>
#include <vector>

namespace nsfd
{
  /**
   * By point: what is joined by common nodes before anything is released, as
   * @p state has it, where its kind becomes `bonded`. A law between two rigid
   * cells of different materials holds them from the start instead: they have
   * no stress that would tell when it is needed. Those of one material are one
   * body, whatever law their faces have. Laws of faults (full friction from the
   * start) hold them from the start, too.
   */
  template <int dim>
  std::vector<std::uint8_t>
  joined_points(const Discretization<dim> &discretization, State &state);

  /**
   * Those that take part in the steps where @p intact (by point) are joined, in
   * ascending order: no supports, no faces at hanging nodes, and whole nodes.
   */
  template <int dim>
  std::vector<unsigned int>
  points_between_groups(const Discretization<dim> &discretization,
                        const JoinedMesh<dim> &mesh,
                        const HangingNodes<dim> &hanging,
                        const std::vector<std::uint8_t> &intact);

  /** Jumps and relative velocities of all points, of the motion of @p state. */
  template <int dim>
  void set_jumps(const Discretization<dim> &discretization,
                 const JoinedMesh<dim> &mesh, State &state);

  /**
   * That what joins cells of two sizes lasts in a run from @p state.
   * @throws std::runtime_error with a sentence for the user, on all ranks.
   */
  template <int dim>
  void check_hanging(const Communicator &communicator,
                     const Discretization<dim> &discretization,
                     const JoinedMesh<dim> &mesh, State &state,
                     HangingNodes<dim> &hanging,
                     PrescribedGroups<dim> &supports);
} // namespace nsfd
