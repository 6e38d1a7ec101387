#pragma once

#include "core/pages_of_zeros.h"

#include <algorithm>
#include <vector>

namespace nsfd
{
  /** @p x at @p places, one unknown for each node. */
  inline void take(const std::vector<int> &places, const double *x,
                   std::vector<double> &values)
  {
    values.resize(places.size());
    for (std::size_t k = 0; k < values.size(); ++k)
      values[k] = x[places[k]];
  }

  /** All of a node at its one unknown, of @p n of them. */
  inline void spread(const std::vector<int> &places,
                     const std::vector<double> &values, const std::size_t n,
                     double *x)
  {
    std::fill(x, x + n, 0.);
    for (std::size_t k = 0; k < values.size(); ++k)
      x[places[k]] = values[k];
  }

  /** dP = c - T dU, T a block of dim x dim per point; 0 but at @p points. */
  template <int dim>
  void answer_of_points(const std::vector<unsigned int> &points,
                        const std::vector<double> &T,
                        const std::vector<double> &c,
                        const std::vector<double> &dU, std::vector<double> &dP)
  {
    dP = c;
    for (const std::size_t i : points)
      for (std::size_t k = i * dim; k < (i + 1) * dim; ++k)
        for (unsigned int e = 0; e < dim; ++e)
          dP[k] -= T[k * dim + e] * dU[i * dim + e];
  }

  /** @p to = @p from, n values per point that are 0 but at @p points. */
  template <unsigned int n>
  void copy_of_points(const std::vector<unsigned int> &points,
                      const std::vector<double> &from, std::vector<double> &to)
  {
    if (to.size() != from.size()) {
      to.assign(from.size(), 0.);
      release_pages_of_zeros(to);
    }
    for (const std::size_t i : points)
      std::copy_n(from.begin() + long(i * n), n, to.begin() + long(i * n));
  }
} // namespace nsfd
