#pragma once

#include "nsfd/mesh/mesh_type.h"

#include <deal.II/base/point.h>
#include <deal.II/grid/tria_description.h>

#include <vector>

namespace nsfd
{
  /** A mesh of one level as plain data, equal on every rank. */
  template <int dim>
  struct CoarseMesh {
    std::vector<dealii::Point<dim>> vertices;
    std::vector<dealii::CellData<dim>> cells;
    /// faces whose boundary id is not 0 or that have a manifold id
    dealii::SubCellData boundary;
  };
} // namespace nsfd
