#pragma once

#include "nsfd/materials/hyperelastic.h"

#include <array>

// Matrices of finite strain, row by row.

namespace nsfd::finite
{
  template <int dim>
  using Matrix = std::array<double, dim * dim>;

  template <int dim>
  Matrix<dim> unit()
  {
    Matrix<dim> F{};
    for (unsigned int c = 0; c < dim; ++c)
      F[c * dim + c] = 1.;
    return F;
  }

  /** F S. */
  template <int dim>
  Matrix<dim> first_piola(const Matrix<dim> &F, const Voigt<dim> &S)
  {
    Matrix<dim> P{};
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int e = 0; e < dim; ++e)
          P[c * dim + d] += F[c * dim + e] * S[voigt_place<dim>(e, d)];
    return P;
  }

  /** det F F^-T. */
  template <int dim>
  Matrix<dim> cofactors(const Matrix<dim> &F)
  {
    if constexpr (dim == 2)
      return {F[3], -F[2], -F[1], F[0]};
    else {
      Matrix<dim> C;
      for (unsigned int a = 0; a < 3; ++a)
        for (unsigned int b = 0; b < 3; ++b) {
          const unsigned int a1 = (a + 1) % 3, a2 = (a + 2) % 3,
                             b1 = (b + 1) % 3, b2 = (b + 2) % 3;
          C[a * 3 + b] =
              F[a1 * 3 + b1] * F[a2 * 3 + b2] - F[a1 * 3 + b2] * F[a2 * 3 + b1];
        }
      return C;
    }
  }

  template <int dim>
  double product(const Matrix<dim> &A, const Matrix<dim> &B)
  {
    double sum = 0.;
    for (unsigned int k = 0; k < dim * dim; ++k)
      sum += A[k] * B[k];
    return sum;
  }

  template <int dim>
  double square(const Matrix<dim> &A)
  {
    return product<dim>(A, A);
  }

  /** A x. */
  template <int dim>
  std::array<double, dim> multiply(const Matrix<dim> &A, const double *x)
  {
    std::array<double, dim> y{};
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int d = 0; d < dim; ++d)
        y[c] += A[c * dim + d] * x[d];
    return y;
  }

  template <int dim>
  double trace(const Matrix<dim> &A)
  {
    double result = 0.;
    for (unsigned int c = 0; c < dim; ++c)
      result += A[c * dim + c];
    return result;
  }

  /**
   * f_i -= weight P g_i: what the stress @p P gives to @p n nodes, with the
   * gradients @p g of their shape functions, sdim numbers each. Rings are
   * strained in space, sdim = 3, by motions in the plane: the third number is
   * N_i/r, along which the radial motion strains them.
   */
  template <int dim, int sdim = dim>
  void subtract_forces(const Matrix<sdim> &P, const double weight,
                       const double *g, const unsigned int n, double *f)
  {
    for (unsigned int i = 0; i < n; ++i) {
      const auto of_node = multiply<sdim>(P, g + i * sdim);
      for (unsigned int c = 0; c < dim; ++c)
        f[i * dim + c] -= weight * of_node[c];
      if constexpr (sdim > dim)
        f[i * dim] -= weight * of_node[dim];
    }
  }

  /** The part of motions in the plane. */
  template <int dim, int sdim>
  Matrix<dim> in_plane(const Matrix<sdim> &A)
  {
    Matrix<dim> result;
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int d = 0; d < dim; ++d)
        result[c * dim + d] = A[c * sdim + d];
    return result;
  }
} // namespace nsfd::finite
