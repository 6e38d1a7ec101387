#pragma once

#include "ghost_cells.h"

#include "discretization/discretization.h"

#include <memory>
#include <optional>
#include <vector>

namespace nsfd
{
  /**
   * A discretization of the cells of this rank and of the ghosts around them,
   * and values from that of the cells of this rank alone to it and back. The
   * nodes, groups, forces and problems of nodes at a border between ranks are
   * then those of one rank, in the same order and to the last bit, on each of
   * the ranks that have a cell there. Where surfaces may meet anywhere the
   * layer is all of the mesh.
   */
  template <int dim>
  class GhostLayer
  {
  public:
    /** Two discretizations of a mesh. Collective. */
    GhostLayer(const Communicator &communicator, const Discretization<dim> &own,
               std::unique_ptr<const Discretization<dim>> all);
    /** With the whole mesh as one rank alone would have it; @p numbers of its
        cells in that of the ranks. Collective. */
    GhostLayer(const Communicator &communicator, const Discretization<dim> &own,
               std::unique_ptr<const Discretization<dim>> whole,
               const std::vector<unsigned long long> &numbers);

    bool is_whole() const { return is_whole_; }
    /** Of the cells of this rank and the ghosts. */
    const Discretization<dim> &all() const { return *all_; }
    const GhostCells &cells() const { return *cells_; }

    /** Values per point of all(), the same on all ranks. Collective. */
    template <typename T>
    unsigned int width(const std::vector<T> &all) const
    {
      const std::size_t n = all_->points().n_points;
      return unsigned(communicator_.max(n > 0 ? double(all.size() / n) : 0.));
    }

    /** @p width values per point: those that this rank knows, 0 elsewhere. */
    template <typename T>
    std::vector<T> spread_points(const std::vector<T> &own,
                                 unsigned int width) const;
    template <typename T>
    std::vector<T> own_points(const std::vector<T> &all,
                              unsigned int width) const;
    /** Unknowns: dim values per node of a cell. */
    std::vector<double> spread_unknowns(const std::vector<double> &own) const;
    std::vector<double> own_unknowns(const std::vector<double> &all) const;
    /** One value per cell. */
    std::vector<double> own_cells(const std::vector<double> &all) const;
    /** State::material_history. */
    std::vector<double> spread_histories(const std::vector<double> &own) const;
    std::vector<double> own_histories(const std::vector<double> &all) const;

    /** What the functions above that spread do not know. Collective. */
    template <typename T>
    void fetch_points(unsigned int width, std::vector<T> &all) const;
    void fetch_unknowns(std::vector<double> &all) const;
    void fetch_histories(std::vector<double> &all) const;

  private:
    /// where the values of a cell begin, by cell
    using First = std::vector<std::size_t>;

    void match_cells(const std::vector<unsigned long long> &numbers);
    void match_points();
    std::vector<double> spread(const First &of_own, const First &of_all,
                               const std::vector<double> &own) const;
    std::vector<double> own_of(const First &of_own, const First &of_all,
                               const std::vector<double> &all) const;
    void fetch(const First &of_all, std::vector<double> &all) const;

    const Communicator &communicator_;
    const Discretization<dim> &own_;
    const std::unique_ptr<const Discretization<dim>> all_;
    const bool is_whole_;
    std::optional<GhostCells> cells_;
    std::vector<std::size_t> cell_;   ///< among all, of own ones
    std::vector<unsigned int> point_; ///< among all, of own ones
    /// points at the slots of a cell, so many for each; n_points where there is
    /// none
    std::vector<unsigned int> points_of_cell_;
    std::size_t n_per_cell_ = 0;
  };
} // namespace nsfd
