#pragma once

#include <cmath>
#include <utility>

/** Products of d x d blocks, row-major. */
namespace nsfd::stored
{
  template <int d>
  bool is_zero(const double *a)
  {
    for (int i = 0; i < d * d; ++i)
      if (a[i] != 0.)
        return false;
    return true;
  }

  template <int d>
  void add(const double *a, double *b)
  {
    for (int i = 0; i < d * d; ++i)
      b[i] += a[i];
  }

  /** c = a b */
  template <int d>
  void multiply(const double *a, const double *b, double *c)
  {
    for (int i = 0; i < d; ++i)
      for (int j = 0; j < d; ++j) {
        double sum = 0.;
        for (int k = 0; k < d; ++k)
          sum += a[d * i + k] * b[d * k + j];
        c[d * i + j] = sum;
      }
  }

  /** c -= a b */
  template <int d>
  void subtract_product(const double *a, const double *b, double *c)
  {
    for (int i = 0; i < d; ++i)
      for (int j = 0; j < d; ++j) {
        double sum = 0.;
        for (int k = 0; k < d; ++k)
          sum += a[d * i + k] * b[d * k + j];
        c[d * i + j] -= sum;
      }
  }

  /** y = a x */
  template <int d>
  void multiply_vector(const double *a, const double *x, double *y)
  {
    for (int i = 0; i < d; ++i) {
      double sum = 0.;
      for (int k = 0; k < d; ++k)
        sum += a[d * i + k] * x[k];
      y[i] = sum;
    }
  }

  /** y -= a x */
  template <int d>
  void subtract_vector(const double *a, const double *x, double *y)
  {
    for (int i = 0; i < d; ++i)
      for (int k = 0; k < d; ++k)
        y[i] -= a[d * i + k] * x[k];
  }

  template <int d>
  bool invert(const double *a, double *inverse);

  /** A determinant that is round-off of its terms is replaced by it, and false
   * returned. */
  template <>
  inline bool invert<2>(const double *a, double *inverse)
  {
    const double b[4] = {a[0], a[1], a[2], a[3]};
    double determinant = b[0] * b[3] - b[1] * b[2];
    const double size = std::abs(b[0] * b[3]) + std::abs(b[1] * b[2]);
    const bool regular = std::abs(determinant) > 1e-15 * size;
    if (!regular)
      determinant = size > 0. ? 1e-15 * size : 1.;
    inverse[0] = b[3] / determinant;
    inverse[1] = -b[1] / determinant;
    inverse[2] = -b[2] / determinant;
    inverse[3] = b[0] / determinant;
    return regular;
  }

  /** By Gauss-Jordan with row pivots; a zero pivot is replaced by the round-off
   * of the block, and false returned. */
  template <>
  inline bool invert<3>(const double *a, double *inverse)
  {
    constexpr int d = 3;
    double m[d][2 * d];
    double largest = 0.;
    for (int i = 0; i < d; ++i)
      for (int j = 0; j < d; ++j) {
        m[i][j] = a[d * i + j];
        m[i][d + j] = i == j;
        largest = std::max(largest, std::abs(m[i][j]));
      }
    bool regular = largest > 0.;
    for (int k = 0; k < d; ++k) {
      int p = k;
      for (int i = k + 1; i < d; ++i)
        if (std::abs(m[i][k]) > std::abs(m[p][k]))
          p = i;
      if (p != k)
        std::swap(m[p], m[k]);
      if (!(std::abs(m[k][k]) > 1e-15 * largest)) {
        m[k][k] = largest > 0. ? 1e-15 * largest : 1.;
        regular = false;
      }
      const double factor = 1. / m[k][k];
      for (int j = k; j < 2 * d; ++j)
        m[k][j] *= factor;
      for (int i = 0; i < d; ++i) {
        if (i == k)
          continue;
        const double f = m[i][k];
        for (int j = k; j < 2 * d; ++j)
          m[i][j] -= f * m[k][j];
      }
    }
    for (int i = 0; i < d; ++i)
      for (int j = 0; j < d; ++j)
        inverse[d * i + j] = m[i][d + j];
    return regular;
  }
} // namespace nsfd::stored
