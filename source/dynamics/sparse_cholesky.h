#pragma once

#include <memory>
#include <vector>

namespace nsfd
{
  /** Compressed rows of a matrix, columns ascending. */
  struct SparseRows
  {
    std::vector<long long> start{0}; ///< size rows + 1
    std::vector<long long> column;
    std::vector<double> value;

    std::size_t n_rows() const { return start.size() - 1; }
  };

  /**
   * L L^T of a sparse symmetric positive definite matrix by CHOLMOD, on one
   * rank. The ordering is kept as long as the pattern is.
   */
  class SparseCholesky
  {
  public:
    SparseCholesky();
    ~SparseCholesky();

    /** All rows of the matrix. @throws std::runtime_error if not definite. */
    void factor(const SparseRows &matrix);

    /** X = A^{-1} B for @p n_columns columns, one after the other. */
    void solve(const double *B, double *X, std::size_t n_columns = 1) const;

  private:
    struct Data;
    std::unique_ptr<Data> data_;
  };
} // namespace nsfd
