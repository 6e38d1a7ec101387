#pragma once

#include "discretization/bodies.h"

namespace nsfd
{
  /**
   * The inverse of A = M + f K of a body, f = (theta h)^2, for any f; of a
   * viscous one f K stands for f K + g C, g = theta h.
   *
   * A rigid motion strains nothing, so A acts on it by the mass alone, which
   * the entries of f K swallow when a wave crosses the body many times in a
   * step: beyond a Courant number of 1e8 A has no Cholesky factor in double
   * precision. With the rigid motions R, R^T M R = 1, and K R = 0,
   *
   *   A^{-1} = (A + s M R R^T M)^{-1} + s / (1 + s) R R^T,
   *
   * where the matrix on the right is as well conditioned as K on strains if s
   * is of the size of f K. This is used where less than four digits of the
   * mass are left in A. Up to there A itself is factorised: the matrix of all
   * bodies has the same entries, and what a step does with both must agree.
   */
  class BlockInverse
  {
  public:
    /** @throws std::runtime_error if A is not positive definite. */
    BlockInverse(const BodyClass &body, const StepShares &shares);

    /** B^T A^{-1} B, symmetric to the last bit. */
    Block form(const Block &B) const;

  private:
    Block factor_, rigid_; ///< L of the matrix above; sqrt(s / (1 + s)) R^T
  };
} // namespace nsfd
