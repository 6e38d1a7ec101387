#pragma once

#include "coarse_mesh.h"

#include <deal.II/grid/tria.h>

#include <algorithm>
#include <exception>
#include <string>

namespace nsfd
{
  /** What deal.II says of an error, in words of the parameter file. */
  std::string level_mesh_message(const std::exception &exception);

  /**
   * The active cells of a mesh without hanging nodes. Manifold ids of faces
   * are groups, or the curved boundaries of a generator.
   */
  template <int dim>
  CoarseMesh<dim> active_level(const dealii::Triangulation<dim> &triangulation,
                               bool with_manifold_ids = false);

  /** The cells may be put into another order of their corners. */
  template <int dim>
  void fill(CoarseMesh<dim> &mesh, dealii::Triangulation<dim> &triangulation);

  template <int dim>
  bool has_simplices(const CoarseMesh<dim> &mesh)
  {
    return std::any_of(
        mesh.cells.begin(), mesh.cells.end(),
        [](const auto &cell) { return cell.vertices.size() != 1u << dim; });
  }
} // namespace nsfd
