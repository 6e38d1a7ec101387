#pragma once

#include "discretization/discretization.h"

namespace nsfd
{
  /**
   * Thickness of the thinnest body that has a cell on this rank, m; infinity if
   * there is none. A body of many cells is at least as thick as its volume over
   * half of its surface.
   */
  template <int dim>
  double thinnest_body(const Discretization<dim> &discretization);
} // namespace nsfd
