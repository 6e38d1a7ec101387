#pragma once

#include <deal.II/base/symmetric_tensor.h>

#include <cmath>

namespace nsfd
{
  /**
   * Of a block of dim x dim, row by row: what is symmetric of it, of each pair
   * of entries the smaller one where their signs agree, without negative
   * eigenvalues. Of a tangent with friction it leaves the contact alone, whose
   * stiffness the mean of the entries would turn by the angle of friction.
   */
  template <int dim>
  void take_positive_part(double *block)
  {
    dealii::SymmetricTensor<2, dim> symmetric, positive;
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int d = c; d < dim; ++d) {
        const double a = block[c * dim + d], b = block[d * dim + c];
        symmetric[c][d] = a * b > 0. ? (std::abs(a) < std::abs(b) ? a : b) : 0.;
      }
    for (const auto &[value, mode] : dealii::eigenvectors(
             symmetric, dealii::SymmetricTensorEigenvectorMethod::jacobi))
      if (value > 0.)
        positive += value * dealii::symmetrize(outer_product(mode, mode));
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int d = 0; d < dim; ++d)
        block[c * dim + d] = positive[c][d];
  }
} // namespace nsfd
