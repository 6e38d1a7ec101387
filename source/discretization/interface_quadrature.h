#pragma once

#include <deal.II/base/quadrature.h>

namespace nsfd
{
  struct DiscretizationInput;

  /** Positions and weights of the points on a face of the reference cell. */
  template <int dim>
  dealii::Quadrature<dim - 1>
  interface_quadrature(const DiscretizationInput &input, bool triangle);
} // namespace nsfd
