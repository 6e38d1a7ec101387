#pragma once

#include "corner_groups.h"

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace nsfd
{
  template <int dim>
  class HangingNodes;

  /**
   * Absorbing sides in explicit steps, lumped to the corners as the mass is. In
   * a kick of length k they take the impulse -k C (v- + v+)/2,
   *
   *   (m + k C/2) v+ = (m - k C/2) v- + k f + P,
   *
   * and the energy k (v- + v+).C (v- + v+)/4, which is never negative: no step
   * is shorter for it.
   */
  template <int dim>
  class AbsorbingNodes
  {
  public:
    /** Null if the scene has none. */
    static std::unique_ptr<AbsorbingNodes>
    make(const Discretization<dim> &discretization, const JoinedMesh<dim> &mesh,
         const HangingNodes<dim> &hanging);

    AbsorbingNodes(const Discretization<dim> &discretization,
                   const JoinedMesh<dim> &mesh,
                   const HangingNodes<dim> &hanging);

    /**
     * @throws std::runtime_error with a sentence for the user, on all ranks,
     * where a side has hanging nodes, or is inclined and has points of faces
     * that may part. Collective.
     */
    void check(const Communicator &communicator) const;

    /** Groups are others now, or more. */
    void gather(const CornerGroups<dim> &groups);

    /** Before the points of a kick act: what they push is heavier. */
    void set_drag(double kick, CornerGroups<dim> &groups);
    /**
     * From the velocities of @p groups after the forces of a kick alone to
     * those with the sides; @p before it. Components in @p prescribed (by
     * group, see PrescribedGroups) stay.
     */
    void brake(double kick, const std::vector<double> &before,
               const std::vector<std::uint8_t> &prescribed,
               CornerGroups<dim> &groups) const;
    /** Adds the impulses, by place of @p row_of_group (-1: none), N s. */
    void add_impulses(double kick, const std::vector<double> &before,
                      const CornerGroups<dim> &groups,
                      const std::vector<int> &row_of_group,
                      std::vector<double> &rows) const;
    /** Into @p terms (dim per group), the energy that they take, J. */
    void put_energy(double kick, const std::vector<double> &before,
                    const CornerGroups<dim> &groups, double *terms) const;

  private:
    using Matrix = std::array<double, dim * dim>;

    enum Fault { none, hangs, is_inclined };

    std::vector<std::pair<unsigned int, Matrix>> of_corners_, of_groups_;
    Fault fault_ = none;
    double kick_ = 0.; ///< of the drag that the groups have
  };
} // namespace nsfd
