#pragma once

#include "core/communicator.h"
#include "linear_algebra/ghost_values.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace nsfd
{
  /**
   * Cells of this rank and, as ghosts, those of other ranks that share a vertex
   * with them, in the order that all cells of the mesh have on one rank. A
   * ghost is computed here as on its own rank; what depends on cells beyond the
   * ghosts comes from there.
   */
  class GhostCells
  {
  public:
    /**
     * @p numbers of the cells in the mesh, consecutive where @p ghost is 0.
     * Collective.
     */
    GhostCells(const Communicator &communicator,
               const std::vector<unsigned long long> &numbers,
               std::vector<std::uint8_t> ghost);

    std::size_t size() const { return ghost_.size(); }
    bool is_ghost(const std::size_t cell) const { return ghost_[cell] != 0; }
    bool anywhere(const bool here) const { return communicator_.any(here); }
    /** The largest one of all ranks. Collective. */
    double largest(const double here) const { return communicator_.max(here); }

    /** Things of cells, @p n each, that this rank wants from their ranks. */
    class Wanted
    {
    public:
      /** @p which of the things: cell times @p n and its number in the cell.
          Collective. */
      Wanted(const GhostCells &cells, unsigned int n,
             std::vector<std::size_t> which);

      /** @p pack (thing of this rank, values). */
      template <typename Pack>
      void start(const unsigned int width, const Pack &pack) const
      {
        values_.start(width, [&](const std::size_t k, double *values) {
          pack(cells_.own_[k / n_] * n_ + k % n_, values);
        });
      }
      /** @p unpack (thing of a ghost, values). */
      template <typename Unpack>
      void finish(const unsigned int width, const Unpack &unpack) const
      {
        values_.finish(width, [&](const std::size_t k, const double *values) {
          unpack(which_[k], values);
        });
      }

    private:
      const GhostCells &cells_;
      const unsigned int n_;
      std::vector<std::size_t> which_; ///< by their numbers in the mesh
      GhostValues values_;
    };

    /** The ghosts themselves. */
    const Wanted &all() const { return *all_; }
    /** One value per cell: of ghosts, from their ranks. */
    void fetch(std::vector<double> &values) const
    {
      all_->start(1, [&](const std::size_t cell, double *value) {
        *value = values[cell];
      });
      all_->finish(1, [&](const std::size_t cell, const double *value) {
        values[cell] = *value;
      });
    }

  private:
    const Communicator &communicator_;
    std::vector<std::uint8_t> ghost_;
    std::vector<unsigned long long> number_; ///< in the mesh
    unsigned long long first_ = 0;           ///< of this rank
    std::vector<std::size_t> own_;           ///< cells by their numbers
    std::unique_ptr<const Wanted> all_;
  };
} // namespace nsfd
