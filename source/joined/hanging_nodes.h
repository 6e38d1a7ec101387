#pragma once

#include "corner_groups.h"
#include "ghost_layer.h"

#include <optional>
#include <utility>
#include <vector>

namespace nsfd
{
  template <int dim>
  class CellForces;

  /**
   * The trace of a cell of quads or hexes at a slot: nodes of the cell on that
   * face and their polynomials, without those that are 0.
   */
  template <int dim>
  std::vector<std::pair<unsigned int, double>>
  trace_at(const Cells<dim> &cells, unsigned int cell, unsigned int slot);

  /**
   * Nodes of smaller cells on the face of a larger one, where that has none:
   * they have no motion of their own,
   *
   *   x_h = C x,   C = polynomials of the nodes of the larger face at x_h,
   *
   * which is to the last digit the trace of the larger cell. Their forces go to
   * the nodes that they follow, C^T f_h, and so do their masses, as sums of the
   * rows of C^T M_h C: as C reproduces linear functions, both momenta stay what
   * they are. Corners of the larger cell, whatever groups they belong to, are
   * what is followed: a larger cell that comes off takes what hangs from it
   * along.
   *
   * A face is never released that is between cells of two sizes or that a
   * hanging node lies on: a hanging node is one group from the start on. Of two
   * larger cells that a node hangs from the first one counts; that the other
   * one has the same trace there is looked after by the faces between them,
   * which have the node on them.
   */
  template <int dim>
  class HangingNodes
  {
  public:
    /**
     * @p layer of the cells, null on one rank, outlives it. Collective.
     * @throws std::runtime_error where what is followed hangs itself: not in
     * meshes whose neighbours, over corners too, differ by one level at most.
     */
    HangingNodes(const Discretization<dim> &discretization,
                 const JoinedMesh<dim> &mesh, const GhostLayer<dim> *layer);

    /** On any rank. */
    bool any() const { return any_; }
    /** The node of a corner does. */
    bool hangs(const std::size_t corner) const
    {
      return any_ && (flags_[corner] & hanging) != 0;
    }
    /** By point: its face is never released; empty: there are none. */
    const std::vector<std::uint8_t> &held() const { return held_; }
    /** The largest sum of |C| along a row. */
    double spread() const { return spread_; }

    /**
     * What the present groups follow, and their masses. False where two larger
     * cells that a node hangs from have separated. Collective.
     */
    bool tie(CornerGroups<dim> &groups);
    /** A group that follows, and the corners of a cell that it follows. */
    struct Tie {
      unsigned int group;
      std::size_t first, last; ///< of master() and weights
      double mass = 0.;        ///< of its corners
    };
    const std::vector<Tie> &ties() const { return ties_; }
    unsigned int master(const std::size_t k) const { return master_[k]; }
    /** Masters of the tie are nodes of a cell of this rank. */
    bool is_own(const Tie &tie) const { return is_own(master_[tie.first]); }
    /**
     * What frequencies of free cells, squared, are multiplied with at most: v.B
     * v over v.D v, B the mass of the nodes of a larger cell and what hangs
     * from them, D its sums of rows, over the cells of this rank; 1 for cells
     * alike, infinity where a sum is not positive.
     */
    double mass_share() const;

    /** Of cells, on the groups that move by themselves. Collective. */
    void set_forces(CellForces<dim> &forces, CornerGroups<dim> &groups) const;
    /** C^T of forces on groups; @p shares is what corners got. Collective. */
    void collect(const CornerGroups<dim> &groups, std::vector<double> &forces,
                 std::vector<double> &shares) const;
    /** Adds the shares of the corners of a node to forces on their groups. */
    void add_shares(std::size_t node, const CornerGroups<dim> &groups,
                    const std::vector<double> &shares,
                    std::vector<double> &forces) const;
    /** Displacements and velocities are C times those of others. Collective. */
    void follow(CornerGroups<dim> &groups) const;

  private:
    enum Flag : std::uint8_t { hanging = 1, loaded = 2 };

    void set_rows();
    void set_flags();
    void set_held();
    bool is_own(unsigned int corner) const;
    bool have_parted(const Tie &one, const Tie &two,
                     const CornerGroups<dim> &groups) const;
    void exchange(unsigned int width, std::vector<double> &shares) const;
    std::size_t place(unsigned int corner) const;

    const Discretization<dim> &discretization_;
    const JoinedMesh<dim> &mesh_;
    const GhostLayer<dim> *const layer_;
    bool any_ = false;
    double spread_ = 1.;
    /// of the points that hang, as JoinedMesh::hanging()
    std::vector<std::size_t> first_;
    std::vector<unsigned int> master_;
    std::vector<double> weight_;
    std::vector<std::uint8_t> flags_; ///< by corner
    std::vector<std::uint8_t> held_;
    /// corners of larger cells at divided faces that are summed here, ascending
    std::vector<unsigned int> loaded_;
    std::optional<GhostCells::Wanted> shares_; ///< of ghosts among them
    std::optional<GhostCells::Wanted> beyond_; ///< hanging, of nodes not whole
    std::vector<Tie> ties_;
  };
} // namespace nsfd
