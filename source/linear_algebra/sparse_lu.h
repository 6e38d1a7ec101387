#pragma once

#include "spd_solver.h"

namespace nsfd
{
  /**
   * Sparse factor of a matrix that need not be symmetric (UMFPACK), on one
   * rank. Its pattern is symmetric, and so is the order of elimination.
   */
  class SparseLU
  {
  public:
    SparseLU() = default;
    ~SparseLU();
    SparseLU(const SparseLU &) = delete;
    SparseLU &operator=(const SparseLU &) = delete;

    /**
     * The rows of @p matrix are taken as the columns of what is factorised; it
     * must stay alive and unchanged. False if it is singular.
     * @throws std::bad_alloc
     */
    bool factorise(const SparseRows &matrix, bool new_pattern);
    void solve(const double *b, double *x) const;

  private:
    const SparseRows *matrix_ = nullptr;
    void *symbolic_ = nullptr, *numeric_ = nullptr;
  };
} // namespace nsfd
