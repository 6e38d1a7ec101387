#include "body_frequency.h"

#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/lapack_full_matrix.h>
#include <deal.II/lac/vector.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  std::array<double, 2> largest_eigenpair(const Block &A)
  {
    const unsigned int n = A.rows;
    dealii::LAPACKFullMatrix<double> matrix(n);
    double bound = 0.;
    for (unsigned int i = 0; i < n; ++i) {
      double row = 0.;
      for (unsigned int j = 0; j < n; ++j) {
        matrix(i, j) = (A(i, j) + A(j, i)) / 2.;
        row += std::abs(matrix(i, j));
      }
      bound = std::max(bound, row);
    }
    dealii::Vector<double> values;
    dealii::FullMatrix<double> vectors;
    matrix.compute_eigenvalues_symmetric(-bound, 1.1 * bound, 0., values,
                                         vectors);
    unsigned int at = 0;
    for (unsigned int k = 1; k < values.size(); ++k)
      if (values[k] > values[at])
        at = k;
    return {{values[at], vectors(n - 1, at)}};
  }

  double highest_frequency(const BodyClass &body)
  {
    if (body.rigid)
      return 0.;
    // of L^{-1} K L^{-T}, M = L L^T
    const Block L = cholesky(body.mass);
    const Block A =
        forward_solve(L, forward_solve(L, body.stiffness).transposed());
    return std::sqrt(std::max(0., largest_eigenpair(A)[0]));
  }
} // namespace nsfd
