#pragma once

#include "discretization.h"

#include <map>

namespace nsfd
{
  /**
   * Thickness at rest of the bodies of the BodyTable that have a cell on this
   * rank, m, by their numbers. A body of many cells is at least as thick as its
   * volume over half of its surface.
   */
  template <int dim>
  std::map<unsigned int, double>
  body_thickness(const Discretization<dim> &discretization);
} // namespace nsfd
