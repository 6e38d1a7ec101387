#pragma once

#include "driven_motion.h"

#include "core/communicator.h"
#include "joined/corner_groups.h"

#include <cstdint>
#include <vector>

namespace nsfd
{
  struct SceneInput;

  /** A component of a group whose motion is prescribed. */
  struct PrescribedRow {
    unsigned int group, component;
    std::size_t point; ///< of the mesh, whose boundary it is
    double given = 0.; ///< impulse of the forces in the step, N s
  };

  /** Components of groups of corners whose motion is prescribed: by supports,
      and on the axis of an axisymmetric scene, where nothing moves radially. */
  template <int dim>
  class PrescribedGroups
  {
  public:
    PrescribedGroups(const SceneInput &input,
                     const Discretization<dim> &discretization,
                     const JoinedMesh<dim> &mesh);

    /**
     * Groups are others now, or more. Those that are @p rigid (by group; empty:
     * none) move with a body: they have rows() all, and what is asked of them
     * is in rigid_rows().
     */
    void find(const CornerGroups<dim> &groups,
              const std::vector<std::uint8_t> &rigid);
    /** Groups behind the old ones are not among them. */
    void resize(std::size_t n_groups);

    /** Of the state before the next step. */
    void set_clock(const LoadClock &clock) { clock_ = clock; }

    /** Bit c of a group: component c; bit dim: it is rigid, and all are. */
    const std::vector<std::uint8_t> &mask() const { return mask_; }

    /**
     * Sets their velocities in the step from @p time over @p h: that of its
     * middle, or what leads to the given place. @p forces are elastic and given
     * ones on the groups, of which the step takes @p kick (s).
     */
    void set_velocities(double time, double h, double kick,
                        const std::vector<double> &forces,
                        const std::vector<double> &loads,
                        CornerGroups<dim> &groups);

    /** Takes them to where they are to be at @p time, if a place is given. */
    void set_places(double time, CornerGroups<dim> &groups) const;

    const std::vector<PrescribedRow> &rigid_rows() const { return rigid_; }
    /** What @p row asks for in the step from @p time over @p h. */
    double velocity(const PrescribedRow &row, double time, double h,
                    const CornerGroups<dim> &groups) const;
    /** Number of the boundary of @p row among the driven ones. */
    std::size_t boundary(const PrescribedRow &row) const;

    /** By place in rows(): impulses of points on the groups, to be set. */
    std::vector<double> &rows() { return rows_; }
    /** By group, -1: none. */
    const std::vector<int> &row_of_group() const { return row_of_group_; }

    /**
     * Work of the impulses that the motions ask for, J, when all velocities are
     * those after the step; @p before are those before it. Sets reactions().
     * Collective.
     */
    double work(const Communicator &communicator, double kick,
                const std::vector<double> &before,
                const CornerGroups<dim> &groups);

    /** Force on each driven boundary, N, dim per boundary. */
    std::vector<double> &reactions() { return reactions_; }
    const std::vector<double> &reactions() const { return reactions_; }

  private:
    const Discretization<dim> &discretization_;
    const JoinedMesh<dim> &mesh_;
    const DrivenMotion<dim> motion_;
    LoadClock clock_;
    std::vector<PrescribedRow> all_, rigid_;
    const std::vector<unsigned int> on_axis_; ///< corners
    std::vector<unsigned int> radial_;        ///< groups of these
    std::vector<std::uint8_t> mask_;
    std::vector<int> row_of_group_;
    std::vector<double> rows_, reactions_, terms_;
  };
} // namespace nsfd
