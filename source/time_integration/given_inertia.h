#pragma once

#include "core/communicator.h"
#include "discretization/discretization.h"
#include "nsfd/bodies/rigid_step.h"

#include <vector>

namespace nsfd
{
  /** Of rigid cells that hang together. */
  struct GivenInertia {
    bool is_given = false; ///< the input says what one of its bodies has
    Vec3 centre{};         ///< of mass, at rest
    RigidInertia inertia;  ///< about it
  };

  /**
   * By body of @p body_of_corner, see rigid_clusters(): of balls, and of
   * materials with a mass or an inertia of their own. Empty: there are none.
   * Collective.
   */
  template <int dim>
  std::vector<GivenInertia>
  given_inertia(const Discretization<dim> &discretization,
                const Communicator &communicator,
                const std::vector<int> &body_of_corner, std::size_t n_bodies);
} // namespace nsfd
