#pragma once

#include <deal.II/base/quadrature.h>

namespace nsfd
{
  struct DiscretizationInput;

  /**
   * Positions and weights of the points on a face of the reference cell. On
   * triangles `gauss lobatto` is its vertices, each with a third of the area:
   * exact for linear functions.
   */
  template <int dim>
  dealii::Quadrature<dim - 1>
  interface_quadrature(const DiscretizationInput &input, bool triangle);
} // namespace nsfd
