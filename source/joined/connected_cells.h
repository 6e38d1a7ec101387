#pragma once

#include "ghost_cells.h"

#include "discretization/discretization.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace nsfd
{
  struct State;

  /** How the two sides of a face hold together. */
  enum class Connection {
    joined, ///< somewhere without a jump: common nodes, a bond or a rigid joint
    intact, ///< by a law that still carries somewhere: beta >= 1e-3, or elastic
    open
  };

  template <int dim>
  Connection connection(const State &state,
                        const typename InterfacePoints<dim>::Face &face);

  /**
   * Which cells hang together: the connected components of all cells over the
   * faces that a caller names, and over those within a body of several cells.
   * Bodies are the components over joined faces, fragments those over faces
   * that are not open, rigid bodies those of rigid cells over intact faces.
   * Ranks find the pieces of their own cells; the first one joins those that
   * meet on several ranks, and sees no others.
   */
  template <int dim>
  class ConnectedCells
  {
  public:
    using Face = typename InterfacePoints<dim>::Face;

    /** @p ghosts of the cells, if there may be some. */
    ConnectedCells(const Discretization<dim> &discretization,
                   const Communicator &communicator,
                   const GhostCells *ghosts = nullptr);

    /** Anew, over the faces between two cells that @p hold. Collective. */
    void connect(const std::function<bool(const Face &)> &hold);

    /** Components of all ranks. */
    unsigned int count() const { return count_; }

    /** Of the component of a cell of this rank: the same for all of its cells
        on all ranks, and for no others. */
    std::uint64_t name(const std::size_t cell) const
    {
      return stands_for_[piece_[cell]];
    }

    /**
     * Component of each cell of this rank, numbered from 0 by their first cell
     * in the order of the cell centres (x, y, z), the same on any number of
     * ranks. Collective; the first rank sorts what there is of pieces.
     */
    std::vector<unsigned int> numbers() const;

  private:
    struct Link {
      unsigned int face, cell; ///< of this rank
      int other;               ///< cell of this rank, or -1
    };
    using Pair =
        std::array<std::uint64_t, 2>; ///< pieces that are one component

    void find_pieces(const std::function<bool(const Face &)> &hold);
    std::vector<Pair>
    pairs_between_ranks(const std::function<bool(const Face &)> &hold) const;
    std::vector<std::uint64_t> pieces_beyond() const;
    void join_pieces(std::vector<Pair> pairs);

    const Discretization<dim> &discretization_;
    const Communicator &communicator_;
    const GhostCells *ghosts_;
    std::vector<Link> links_;         ///< faces between two cells, counted here
    std::vector<unsigned int> piece_; ///< per cell, from 0 on each rank
    unsigned int n_pieces_ = 0, count_ = 0;
    std::uint64_t first_piece_ = 0; ///< number among those of all ranks
    /// per piece of this rank: the one that stands for its component, of any
    std::vector<std::uint64_t> stands_for_;
  };
} // namespace nsfd
