#include "stable_step.h"

#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/lapack_full_matrix.h>
#include <deal.II/lac/vector.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  double stable_step(const Bodies &bodies)
  {
    double largest = 0.; // omega^2
    for (const BodyClass &body : bodies.classes) {
      if (body.rigid)
        continue;
      // of L^{-1} K L^{-T}, M = L L^T
      const Block L = cholesky(body.mass);
      const Block A =
        forward_solve(L, forward_solve(L, body.stiffness).transposed());
      dealii::LAPACKFullMatrix<double> matrix(body.n_dofs);
      double trace = 0.;
      for (unsigned int i = 0; i < body.n_dofs; ++i) {
        trace += A(i, i);
        for (unsigned int j = 0; j < body.n_dofs; ++j)
          matrix(i, j) = (A(i, j) + A(j, i)) / 2.;
      }
      dealii::Vector<double> eigenvalues;
      dealii::FullMatrix<double> eigenvectors;
      matrix.compute_eigenvalues_symmetric(0., 1.1 * trace, 0., eigenvalues,
                                           eigenvectors);
      largest = std::max(
        largest, *std::max_element(eigenvalues.begin(), eigenvalues.end()));
    }
    return largest > 0. ? 2. / std::sqrt(largest)
                        : std::numeric_limits<double>::infinity();
  }
} // namespace nsfd
