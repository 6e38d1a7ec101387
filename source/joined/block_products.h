#pragma once

#include "corner_groups.h"

#include "discretization/bodies.h"
#include "linear_algebra/block_kernels.h"

#include <algorithm>
#include <vector>

namespace nsfd
{
  /**
   * Products of blocks of the bodies with a @p motion of their groups, some
   * bodies at once: calls take(body, lane, x, y, t) with x the motion of its
   * corners, y = @p matrix x and t = @p traction x, entry j of the body at
   * j lanes + lane. Bodies without a matrix are left out.
   */
  template <int dim, typename Take>
  void for_block_products(const Bodies &bodies, const CornerGroups<dim> &groups,
                          const std::vector<double> &motion,
                          const Block BodyClass::*const matrix,
                          const Block BodyClass::*const traction,
                          const Take &take)
  {
    std::vector<double> x, y, t;
    for (const BodyClass &body : bodies.classes) {
      const Block &A = body.*matrix, &T = body.*traction;
      if (A.rows == 0)
        continue;
      x.assign(std::size_t(body.n_dofs) * lanes, 0.);
      y.resize(std::size_t(padded(body.n_dofs)) * lanes);
      t.resize(std::size_t(padded(T.rows)) * lanes);
      for (std::size_t first = 0; first < body.bodies.size(); first += lanes) {
        const auto count =
            unsigned(std::min<std::size_t>(lanes, body.bodies.size() - first));
        for (unsigned int l = 0; l < count; ++l) {
          const std::size_t dof = bodies.first_dof[body.bodies[first + l]];
          for (unsigned int j = 0; j < body.n_dofs; ++j)
            x[j * lanes + l] =
                motion[groups.of((dof + j) / dim) * dim + j % dim];
        }
        multiply_lanes(A.values.data(), body.n_dofs, body.n_dofs, x.data(),
                       y.data());
        if (T.rows > 0)
          multiply_lanes(T.values.data(), T.rows, body.n_dofs, x.data(),
                         t.data());
        for (unsigned int l = 0; l < count; ++l)
          take(body.bodies[first + l], l, x, y, t);
      }
    }
  }
} // namespace nsfd
