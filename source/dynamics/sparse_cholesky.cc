#include "sparse_cholesky.h"

#include <suitesparse/cholmod.h>

#include <algorithm>
#include <stdexcept>

namespace nsfd
{
  struct SparseCholesky::Data
  {
    Data()
    {
      cholmod_l_start(&common);
      common.print = 0;
      common.supernodal = CHOLMOD_AUTO;
    }
    ~Data()
    {
      forget();
      cholmod_l_free_dense(&Y, &common);
      cholmod_l_free_dense(&E, &common);
      cholmod_l_free_dense(&X, &common);
      cholmod_l_finish(&common);
    }
    void forget()
    {
      if (factor)
        cholmod_l_free_factor(&factor, &common);
    }

    mutable cholmod_common common;
    cholmod_factor *factor = nullptr;
    mutable cholmod_dense *X = nullptr, *Y = nullptr, *E = nullptr;
    std::vector<long long> start, column; ///< of the analysed pattern
    std::size_t n = 0;
  };

  SparseCholesky::SparseCholesky()
    : data_(std::make_unique<Data>())
  {
  }
  SparseCholesky::~SparseCholesky() = default;

  void SparseCholesky::factor(const SparseRows &matrix)
  {
    Data &d = *data_;
    d.n = matrix.n_rows();
    // rows of a symmetric matrix are its columns; the upper half is taken
    cholmod_sparse A{};
    A.nrow = A.ncol = d.n;
    A.nzmax = matrix.value.size();
    A.p = const_cast<long long *>(matrix.start.data());
    A.i = const_cast<long long *>(matrix.column.data());
    A.x = const_cast<double *>(matrix.value.data());
    A.stype = 1;
    A.itype = CHOLMOD_LONG;
    A.xtype = CHOLMOD_REAL;
    A.dtype = CHOLMOD_DOUBLE;
    A.sorted = A.packed = 1;
    if (!d.factor || d.start != matrix.start || d.column != matrix.column) {
      d.forget();
      d.factor = cholmod_l_analyze(&A, &d.common);
      d.start = matrix.start;
      d.column = matrix.column;
    }
    cholmod_l_factorize(&A, d.factor, &d.common);
    if (d.common.status != CHOLMOD_OK || d.factor->minor < d.n)
      throw std::runtime_error("the sparse matrix of the bodies is not "
                               "positive definite");
  }

  void SparseCholesky::solve(const double *B, double *X,
                             const std::size_t n_columns) const
  {
    const Data &d = *data_;
    cholmod_dense b{};
    b.nrow = b.d = d.n;
    b.ncol = n_columns;
    b.nzmax = d.n * n_columns;
    b.x = const_cast<double *>(B);
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    cholmod_l_solve2(CHOLMOD_A, d.factor, &b, nullptr, &d.X, nullptr, &d.Y,
                     &d.E, &d.common);
    std::copy_n(static_cast<const double *>(d.X->x), d.n * n_columns, X);
  }
} // namespace nsfd
