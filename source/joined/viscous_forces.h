#pragma once

#include "corner_groups.h"

namespace nsfd
{
  template <int dim>
  class HangingNodes;

  /**
   * Forces -C v of viscous materials on groups of corners, of the velocity that
   * they have after a step; they act in the next one. A kick of length k, with
   * the steps h_last before and h after it, takes
   *
   *   k v-.C (v- + v+)/2 = k |v- + v+|_C^2/4 + k (|v-|_C^2 - |v+|_C^2)/4 .
   *
   * The first part is never negative. The second one is what the kinetic energy
   * of the scheme holds: it is less by h |v|_C^2/4; where steps change, (h -
   * h_last)(|v-|_C^2 + |v+|_C^2)/8 is numerical, but for the first one. v.(M -
   * h^2 K/4 - h C/2) v > 0 bounds the step.
   */
  template <int dim>
  class ViscousForces
  {
  public:
    ViscousForces(const Discretization<dim> &discretization,
                  const JoinedMesh<dim> &mesh);

    /** Of the velocities of @p groups; those of what is @p hanging are on
        what it follows. Collective. */
    void set(const CornerGroups<dim> &groups, const HangingNodes<dim> &hanging);
    /** A node has split. */
    void gather(std::size_t node, const CornerGroups<dim> &groups,
                const HangingNodes<dim> &hanging);

    /** dim values per group, N. */
    const std::vector<double> &of_groups() const { return of_groups_; }

    bool acts_in(const std::size_t cell) const
    {
      return first_traction_[cell + 1] > first_traction_[cell];
    }
    /** Traction at a point on the normal from body 1 to body 2: the mean of
       both sides, Pa. */
    std::array<double, dim> traction(std::size_t point) const;

  private:
    const Discretization<dim> &discretization_;
    const JoinedMesh<dim> &mesh_;
    std::vector<double> of_corners_, of_groups_;
    std::vector<double> shares_;              ///< see HangingNodes
    std::vector<double> tractions_;           ///< on the outward normal, Pa
    std::vector<std::size_t> first_traction_; ///< per body, and the end
    std::vector<std::array<std::size_t, 2>> place_; ///< by point, of body 1, 2
  };
} // namespace nsfd
