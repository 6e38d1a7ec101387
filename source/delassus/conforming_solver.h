#pragma once

#include "linear_algebra/spd_solver.h"

namespace nsfd
{
  /**
   * Solves among the functions of the space alone,
   *
   *     x = P (P^T A P)^{-1} P^T b:
   *
   * joined cells with common nodes. P^T A P has a sparse Cholesky factor up to
   * @p largest_factor unknowns; beyond, conjugate gradients that one V-cycle of
   * smoothed aggregation preconditions, with the factor's accuracy asked for by
   * the tolerance of solve().
   */
  std::unique_ptr<SpdSolver>
  make_conforming_solver(const Communicator &communicator,
                         long long largest_factor);
} // namespace nsfd
