#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

/** Small matrices of rigid motions. */
namespace nsfd::rigid
{
  template <std::size_t n>
  using Square = std::array<std::array<double, n>, n>;

  template <std::size_t n>
  std::array<double, n> times(const Square<n> &A,
                              const std::array<double, n> &x)
  {
    std::array<double, n> y{};
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        y[i] += A[i][j] * x[j];
    return y;
  }

  template <std::size_t n>
  double product(const std::array<double, n> &x, const std::array<double, n> &y)
  {
    double sum = 0.;
    for (std::size_t i = 0; i < n; ++i)
      sum += x[i] * y[i];
    return sum;
  }

  /** Eigenvectors of A as columns, A becomes diagonal: Jacobi's rotations. */
  template <std::size_t n>
  Square<n> diagonalise(Square<n> &A)
  {
    Square<n> Q{};
    for (std::size_t i = 0; i < n; ++i)
      Q[i][i] = 1.;
    for (unsigned int sweep = 0; sweep < 50; ++sweep) {
      double off = 0., all = 0.;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
          (i == j ? all : off) += A[i][j] * A[i][j];
      if (off <= 1e-34 * all)
        break;
      for (std::size_t p = 0; p < n; ++p)
        for (std::size_t q = p + 1; q < n; ++q) {
          if (A[p][q] == 0.)
            continue;
          const double angle = (A[q][q] - A[p][p]) / (2. * A[p][q]);
          const double t = (angle >= 0. ? 1. : -1.) /
                           (std::abs(angle) + std::hypot(1., angle));
          const double c = 1. / std::hypot(1., t), s = t * c;
          for (std::size_t k = 0; k < n; ++k) {
            const double a = A[k][p], b = A[k][q];
            A[k][p] = c * a - s * b;
            A[k][q] = s * a + c * b;
          }
          for (std::size_t k = 0; k < n; ++k) {
            const double a = A[p][k], b = A[q][k];
            A[p][k] = c * a - s * b;
            A[q][k] = s * a + c * b;
            const double x = Q[k][p], y = Q[k][q];
            Q[k][p] = c * x - s * y;
            Q[k][q] = s * x + c * y;
          }
        }
    }
    return Q;
  }

  /** Makes @p columns those of E with E^T M E = 1, in their span. */
  template <std::size_t n>
  void normalise(const Square<n> &M,
                 std::vector<std::array<double, n>> &columns)
  {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      for (unsigned int twice = 0; twice < 2; ++twice)
        for (std::size_t l = 0; l < k; ++l) {
          const double share = product(columns[l], times(M, columns[k]));
          for (std::size_t i = 0; i < n; ++i)
            columns[k][i] -= share * columns[l][i];
        }
      const double size = std::sqrt(product(columns[k], times(M, columns[k])));
      for (double &x : columns[k])
        x /= size;
    }
  }
} // namespace nsfd::rigid
