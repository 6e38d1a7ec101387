#pragma once

#include "coarse_mesh.h"

#include <string>
#include <vector>

namespace nsfd
{
  /**
   * Quads or hexes in the box between the two corners of @p input, with
   * 2^refinements times its cells. Empty where there are @p problems.
   */
  template <int dim>
  CoarseMesh<dim> lattice_mesh(const MeshInput &input, unsigned int refinements,
                               std::vector<std::string> &problems);

  /** Take the cells of the slot out, if it has a width. */
  template <int dim>
  void cut_notch(const MeshInput &input, CoarseMesh<dim> &mesh,
                 std::vector<std::string> &problems);

  /** The mesh of [AM06]: both diagonals of every rectangle. */
  CoarseMesh<2> cut_in_four(const CoarseMesh<2> &boxes);

  /**
   * Kuhn's simplices, all on the diagonal from the lower to the upper
   * corner: one per order in which the axes are walked.
   */
  template <int dim>
  CoarseMesh<dim> cut_along_diagonal(const CoarseMesh<dim> &boxes);
} // namespace nsfd
