#pragma once

#include "ghost_cells.h"

#include "discretization/discretization.h"

#include <array>
#include <cstdint>
#include <vector>

namespace nsfd
{
  /**
   * The nodes of cells that may hang together. A corner is a node of one cell;
   * the points of a face sit at its nodes and link the corners of its two
   * cells. Corners that links connect, intact or not, are one node of the mesh.
   * At faces between cells of two sizes only points where both have a node are
   * links; the others are hanging(): see HangingNodes.
   * Where ghosts are around the cells of a rank, nodes with a corner of one of
   * its own are whole; corners at other nodes stand alone, and move as other
   * ranks say.
   */
  template <int dim>
  class JoinedMesh
  {
  public:
    static constexpr unsigned int none = unsigned(-1);

    /**
     * @throws std::runtime_error where a point is not at a node of its cells:
     * other interface quadratures. The same on all ranks; @p ghosts of the
     * cells, if there may be some.
     */
    explicit JoinedMesh(const Discretization<dim> &discretization,
                        const GhostCells *ghosts = nullptr);

    std::size_t n_corners() const { return node_.size(); }
    std::size_t n_nodes() const { return first_corner_.size() - 1; }

    unsigned int node(const std::size_t corner) const { return node_[corner]; }
    /** Lumped, kg, or kg/m in the plane. */
    double mass(const std::size_t corner) const { return mass_[corner]; }
    /** Of body 1 and of body 2 of a point; none where there is no such body. */
    const std::array<unsigned int, 2> &corners(const std::size_t point) const
    {
      return corners_[point];
    }
    /** The one that a point at the boundary has, or that of body 1. */
    unsigned int a_corner(const std::size_t point) const
    {
      const auto &sides = corners_[point];
      return sides[0] != none ? sides[0] : sides[1];
    }
    unsigned int node_of_point(const std::size_t point) const
    {
      return node_[a_corner(point)];
    }

    /** A point of a smaller cell at its face with a larger one that has no node
        there; corners() has the smaller one alone. */
    struct Hanging {
      unsigned int point, corner; ///< of the smaller cell
      unsigned int cell, slot;    ///< of the larger one
    };
    /** By the cells and slots. */
    const std::vector<Hanging> &hanging() const { return hanging_; }
    /** The face of the point is between cells of two sizes. */
    bool between_sizes(const std::size_t point) const
    {
      return !between_sizes_.empty() && between_sizes_[point] != 0;
    }

    /** All corners of the node are here: of nodes of the cells of this rank,
        and of those that hang from them. */
    bool is_whole(const std::size_t node) const
    {
      return share_.empty() || share_[node] != Share::part;
    }
    /** Of the ranks that have the whole node, this one sums over it. */
    bool counts(const std::size_t node) const
    {
      return share_.empty() || share_[node] == Share::counted;
    }

    struct Range {
      const unsigned int *first, *last;
      const unsigned int *begin() const { return first; }
      const unsigned int *end() const { return last; }
      std::size_t size() const { return std::size_t(last - first); }
    };
    /** In the order of the cells. */
    Range corners_of_node(const std::size_t node) const
    {
      return {corner_.data() + first_corner_[node],
              corner_.data() + first_corner_[node + 1]};
    }
    /** Points between two corners of the node. */
    Range links_of_node(const std::size_t node) const
    {
      return {link_.data() + first_link_[node],
              link_.data() + first_link_[node + 1]};
    }

  private:
    enum class Share : std::uint8_t { counted, whole, part };

    void find_corners(const Discretization<dim> &discretization,
                      const GhostCells *ghosts);
    std::vector<std::uint8_t> near_own(const Cells<dim> &cells,
                                       const GhostCells &ghosts) const;
    void find_nodes(const std::vector<std::uint8_t> &own);
    void sort_corners();
    void share_nodes(const std::vector<std::uint8_t> &own);
    void sort_links();

    std::vector<unsigned int> node_;
    std::vector<double> mass_;
    std::vector<std::array<unsigned int, 2>> corners_;
    std::vector<Hanging> hanging_;
    std::vector<std::uint8_t> between_sizes_; ///< by point; empty: none is
    std::vector<std::size_t> first_corner_, first_link_; ///< size n + 1
    std::vector<unsigned int> corner_, link_;
    std::vector<Share> share_; ///< by node; empty: there are no ghosts
  };
} // namespace nsfd
