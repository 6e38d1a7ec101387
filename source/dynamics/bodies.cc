#include "nsfd/dynamics/bodies.h"

#include <cmath>
#include <stdexcept>

namespace nsfd
{
  Block::Block(const unsigned int rows_, const unsigned int cols_)
    : rows(rows_), cols(cols_), values(std::size_t(padded(rows_)) * cols_, 0.)
  {}

  Block Block::transposed() const
  {
    Block result(cols, rows);
    for (unsigned int c = 0; c < cols; ++c)
      for (unsigned int r = 0; r < rows; ++r)
        result(c, r) = (*this)(r, c);
    return result;
  }

  Block product(const Block &A, const Block &B)
  {
    Block C(A.rows, B.cols);
    for (unsigned int j = 0; j < B.cols; ++j)
      for (unsigned int k = 0; k < A.cols; ++k) {
        const double b = B(k, j);
        if (b != 0.)
          for (unsigned int i = 0; i < A.rows; ++i)
            C(i, j) += A(i, k) * b;
      }
    return C;
  }

  Block cholesky(const Block &A)
  {
    const unsigned int n = A.rows;
    Block L(n, n);
    for (unsigned int j = 0; j < n; ++j) {
      double diagonal = A(j, j);
      for (unsigned int k = 0; k < j; ++k)
        diagonal -= L(j, k) * L(j, k);
      if (!(diagonal > 0.))
        throw std::runtime_error("a body's iteration matrix is not positive "
                                 "definite: check density and moduli");
      L(j, j) = std::sqrt(diagonal);
      for (unsigned int i = j + 1; i < n; ++i) {
        double value = A(i, j);
        for (unsigned int k = 0; k < j; ++k)
          value -= L(i, k) * L(j, k);
        L(i, j) = value / L(j, j);
      }
    }
    return L;
  }

  Block forward_solve(const Block &L, Block B)
  {
    for (unsigned int j = 0; j < B.cols; ++j)
      for (unsigned int i = 0; i < B.rows; ++i) {
        const double value = B(i, j) / L(i, i);
        B(i, j) = value;
        for (unsigned int k = i + 1; k < B.rows; ++k)
          B(k, j) -= L(k, i) * value;
      }
    return B;
  }

  Block gram(const Block &A)
  {
    Block G(A.cols, A.cols);
    for (unsigned int j = 0; j < A.cols; ++j)
      for (unsigned int i = 0; i <= j; ++i) {
        double value = 0.;
        for (unsigned int k = 0; k < A.rows; ++k)
          value += A(k, i) * A(k, j);
        G(i, j) = G(j, i) = value;
      }
    return G;
  }
} // namespace nsfd
