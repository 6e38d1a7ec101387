#pragma once

#include "discretization.h"

#include <vector>

namespace nsfd
{
  /**
   * Per unknown of a deformable body the coordinate of its node along its own
   * component, what make_assembled_delassus() glues by. Of no meaning for the
   * modes of rigid bodies.
   */
  template <int dim>
  std::vector<double>
  node_coordinates(const Discretization<dim> &discretization)
  {
    return discretization.interpolate(
        [](const dealii::Point<dim> &x, unsigned int, double *values) {
          for (unsigned int c = 0; c < dim; ++c)
            values[c] = x[c];
        });
  }
} // namespace nsfd
