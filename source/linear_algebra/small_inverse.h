#pragma once

#include <cstddef>

namespace nsfd
{
  /**
   * The inverse of a symmetric positive semidefinite matrix of @p n rows, in
   * place, row by row at @p stride, by Gauss-Jordan elimination in the order of
   * the rows. A row that others determine already, of which they leave
   * @p least of its diagonal or less, is told to left_out(row); the inverse is
   * that of the others, and zero there. At most @p most rows.
   */
  template <std::size_t most, typename LeftOut>
  void invert_in_place(double *a, const std::size_t n, const std::size_t stride,
                       const double least, const LeftOut &left_out)
  {
    // the diagonal before anything is taken away from it
    double diagonal[most];
    bool is_out[most];
    bool any_out = false;
    for (std::size_t k = 0; k < n; ++k) {
      diagonal[k] = a[k * stride + k];
      is_out[k] = false;
    }
    for (std::size_t k = 0; k < n; ++k) {
      double *mine = a + k * stride;
      const double pivot = mine[k];
      if (!(pivot > least * diagonal[k])) {
        is_out[k] = any_out = true;
        left_out(k);
        continue;
      }
      const double inverse = 1. / pivot;
      for (std::size_t j = 0; j < n; ++j)
        mine[j] *= inverse;
      for (std::size_t i = 0; i < n; ++i) {
        double *other = a + i * stride;
        const double factor = other[k];
        if (i == k || factor == 0.)
          continue;
        for (std::size_t j = 0; j < n; ++j)
          other[j] -= factor * mine[j];
        other[k] = -factor * inverse;
      }
      mine[k] = inverse;
    }
    for (std::size_t k = 0; any_out && k < n; ++k)
      if (is_out[k])
        for (std::size_t j = 0; j < n; ++j)
          a[k * stride + j] = a[j * stride + k] = 0.;
  }
} // namespace nsfd
