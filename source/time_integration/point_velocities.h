#pragma once

#include "leapfrog_chains.h"

#include "joined/corner_groups.h"

#include <vector>

namespace nsfd
{
  /** U of the points @p moved of a step from @p first on. */
  template <int dim>
  void set_velocities(const std::vector<unsigned int> &moved, std::size_t first,
                      const JoinedMesh<dim> &mesh,
                      const CornerGroups<dim> &groups,
                      LeapfrogChains<dim> &chains);

  /** The U before the step of a point: that of its groups now. */
  template <int dim>
  void set_old_velocity(unsigned int point, const JoinedMesh<dim> &mesh,
                        const CornerGroups<dim> &groups,
                        LeapfrogChains<dim> &chains);

  /**
   * Friction that opposes the velocity of the end of a step gives energy where
   * sliding turns round in it: such points oppose the mean from then on, which
   * never gives any; or @p all that rub, where the problem was not solved. True
   * if there are new ones.
   */
  template <int dim>
  bool turn_friction(const std::vector<unsigned int> &moved, std::size_t first,
                     bool all, LeapfrogChains<dim> &chains);
} // namespace nsfd
