#pragma once

#include "joined_mesh.h"

namespace nsfd
{
  /**
   * Corners of a node that hang together through intact links are one group:
   * one position, one velocity, the sum of their masses. An intact body is an
   * ordinary finite element mesh; nodes split as their links are released.
   */
  template <int dim>
  class CornerGroups
  {
  public:
    /** @p intact by point. */
    CornerGroups(const JoinedMesh<dim> &mesh,
                 const std::vector<std::uint8_t> &intact);

    std::size_t size() const { return mass.size(); }
    unsigned int of(const std::size_t corner) const { return of_[corner]; }
    /** By corner. */
    const std::vector<unsigned int> &of_corners() const { return of_; }

    /** Over which this rank does not sum, see JoinedMesh: few, ascending. */
    const std::vector<unsigned int> &not_counted() const
    {
      return not_counted_;
    }

    /**
     * After links of @p node are released: what does not hang together any more
     * gets groups of its own, behind all others, at the same place and speed.
     * False if nothing was cut. Forces are to be set anew.
     */
    bool split(std::size_t node, const std::vector<std::uint8_t> &intact);

    /** Of the corners, instead of those of the mesh. */
    void set_masses(std::vector<double> of_corners);

    /** Mass-weighted means of what the corners have, dim values each. */
    void gather(const std::vector<double> &of_corners,
                std::vector<double> &of_groups) const;
    /** To every corner that of its group. */
    void scatter(const std::vector<double> &of_groups,
                 std::vector<double> &of_corners) const;

    /** Of what an impulse pushes, 1/kg: heavier by the drag. */
    double inverse_mass(const std::size_t group, const unsigned int c) const
    {
      const std::size_t k = group * dim + c;
      return 1. / (k < drag.size() ? mass[group] + drag[k] : mass[group]);
    }

    std::vector<double> mass; ///< kg, or kg/m in the plane
    /// the same by component, what absorbing sides add to the mass in the
    /// present kick, see AbsorbingNodes; empty: nothing
    std::vector<double> drag;
    /// dim components per group: m, m/s and N
    std::vector<double> displacement, velocity, force;
    /// N, of `force`: what corners got from hanging nodes, see HangingNodes
    std::vector<double> shares;

  private:
    const std::vector<unsigned int> &
    components(std::size_t node, const std::vector<std::uint8_t> &intact);

    double mass_of(const std::size_t corner) const
    {
      return masses_.empty() ? mesh_.mass(corner) : masses_[corner];
    }

    const JoinedMesh<dim> &mesh_;
    std::vector<double> masses_; ///< by corner; empty: those of the mesh
    std::vector<unsigned int> of_;
    std::vector<unsigned int> component_; ///< of the corners of a node
    std::vector<unsigned int> not_counted_;
  };
} // namespace nsfd
