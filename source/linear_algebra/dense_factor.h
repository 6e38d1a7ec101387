#pragma once

#include <vector>

namespace nsfd
{
  /** Factor of a dense matrix of some thousand unknowns (LAPACK). */
  class DenseFactor
  {
  public:
    /**
     * @p matrix by columns; of a symmetric one the lower triangle is read,
     * and the factor is one of Cholesky. False: not positive definite, or
     * singular; there is no factor then.
     */
    bool factorise(std::vector<double> &&matrix, int n, bool symmetric);
    /** In place. */
    void solve(double *x) const;

    void clear() { *this = DenseFactor(); }
    int size() const { return n_; }

  private:
    int n_ = 0;
    std::vector<double> values_;
    std::vector<int> pivots_; ///< of what is not symmetric
  };
} // namespace nsfd
