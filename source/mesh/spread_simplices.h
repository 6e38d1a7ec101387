#pragma once

#include "coarse_mesh.h"

#include <deal.II/grid/tria.h>

#include <memory>
#include <mpi.h>

namespace nsfd
{
  /**
   * Triangles or tetrahedra over the ranks, in parts of about equal size with
   * few faces between them (METIS). A rank holds its own cells, those that
   * share a vertex with one of them (ghosts), and, as artificial ones, those
   * behind the faces of ghosts, so that faces of its cells and of ghosts are at
   * the boundary where those of the whole mesh are. Cells keep their ids, and
   * their order.
   *
   * @p mesh is that of rank 0, which hands out the parts and keeps no more than
   * its own; those of other ranks are not looked at. Collective.
   *
   * @throws std::runtime_error on all ranks, if a part is no mesh.
   */
  template <int dim>
  std::unique_ptr<dealii::Triangulation<dim>>
  spread_simplices(CoarseMesh<dim> &&mesh, MPI_Comm communicator);
} // namespace nsfd
