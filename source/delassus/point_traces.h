#pragma once

#include "delassus_operator.h"

#include <array>
#include <vector>

namespace nsfd
{
  /**
   * What a point sees of the unknowns of its bodies, in its frame and known on
   * every rank that has the point: rows of the jump, and of the traction where
   * the bodies have one.
   */
  struct PointTrace {
    long long first = -1; ///< first unknown among those of all ranks, or none
    unsigned int n_dofs = 0;
    std::vector<double> jump;     ///< dim x n_dofs, with the sign of the side
    std::vector<double> traction; ///< the same: sigma n, n from body 1 to 2
    std::vector<double>
        viscous_traction; ///< of velocities; empty: none viscous
  };

  /** Per side and point. Collective. */
  template <int dim>
  std::array<std::vector<PointTrace>, 2>
  point_traces(const DelassusOperator<dim> &delassus, long long first_dof,
               bool with_traction);
} // namespace nsfd
