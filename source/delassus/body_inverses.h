#pragma once

#include "linear_algebra/spd_solver.h"

#include <vector>

namespace nsfd
{
  /** Inverses of the diagonal blocks of a sparse matrix, one per body. */
  class BodyInverses
  {
  public:
    explicit BodyInverses(std::vector<std::size_t> first_dof)
        : first_dof_(std::move(first_dof))
    {
    }

    void prepare(const SparseRows &matrix);
    /** z = sum_b E_b A_bb^{-1} E_b^T r. */
    void apply(const double *r, double *z) const;

  private:
    const std::vector<std::size_t> first_dof_;
    std::vector<std::size_t> offset_;
    std::vector<double> inverses_, work_;
  };
} // namespace nsfd
