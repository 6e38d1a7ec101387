#pragma once

#include "cell_set.h"

#include <deal.II/grid/cell_id.h>
#include <deal.II/grid/tria.h>

#include <algorithm>
#include <vector>

namespace nsfd
{
  template <int dim>
  using ActiveCells =
      std::vector<typename dealii::Triangulation<dim>::active_cell_iterator>;

  /**
   * In the order of the bodies. Where cells have been refined it is that of
   * their ids: the order in which a mesh was made does not show.
   */
  template <int dim>
  void put_in_order(const bool refined, ActiveCells<dim> &cells)
  {
    if (refined)
      std::sort(cells.begin(), cells.end(),
                [](const auto &a, const auto &b) { return a->id() < b->id(); });
  }

  /** The cells of this rank, and those around them if @p set says so. */
  template <int dim>
  ActiveCells<dim> cells_of(const dealii::Triangulation<dim> &triangulation,
                            const CellSet set)
  {
    ActiveCells<dim> cells;
    for (const auto &cell : triangulation.active_cell_iterators())
      if (cell->is_locally_owned() ||
          (set == CellSet::with_ghosts && cell->is_ghost()))
        cells.push_back(cell);
    put_in_order<dim>(triangulation.n_global_levels() > 1, cells);
    return cells;
  }

  /** The cells of this rank. */
  template <int dim>
  ActiveCells<dim> owned_cells(const dealii::Triangulation<dim> &triangulation)
  {
    return cells_of(triangulation, CellSet::own);
  }

  /** Those of all ranks, of a mesh that every rank knows as a whole. */
  template <int dim>
  ActiveCells<dim> all_cells(const dealii::Triangulation<dim> &triangulation)
  {
    ActiveCells<dim> cells;
    for (const auto &cell : triangulation.active_cell_iterators())
      cells.push_back(cell);
    put_in_order<dim>(triangulation.n_levels() > 1, cells);
    return cells;
  }

  /** The body of every active cell, by its index; -1: none of @p set. */
  template <int dim>
  std::vector<int>
  bodies_of_cells(const dealii::Triangulation<dim> &triangulation,
                  const CellSet set = CellSet::own)
  {
    std::vector<int> result(triangulation.n_active_cells(), -1);
    const auto cells = cells_of(triangulation, set);
    for (std::size_t b = 0; b < cells.size(); ++b)
      result[cells[b]->active_cell_index()] = int(b);
    return result;
  }
} // namespace nsfd
