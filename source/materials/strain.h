#pragma once

#include "nsfd/materials/hyperelastic.h"

namespace nsfd
{
  template <int dim>
  double jacobian(const double *F)
  {
    if (dim == 2)
      return F[0] * F[3] - F[1] * F[2];
    return F[0] * (F[4] * F[8] - F[5] * F[7]) -
           F[1] * (F[3] * F[8] - F[5] * F[6]) +
           F[2] * (F[3] * F[7] - F[4] * F[6]);
  }

  /** The symmetric part of A^T B. */
  template <int dim>
  Voigt<dim> symmetric_product(const double *A, const double *B)
  {
    Voigt<dim> C{};
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = a; b < dim; ++b) {
        double sum = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          sum +=
              A[c * dim + a] * B[c * dim + b] + A[c * dim + b] * B[c * dim + a];
        C[voigt_place<dim>(a, b)] = sum / 2.;
      }
    return C;
  }
} // namespace nsfd
