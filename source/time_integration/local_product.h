#pragma once

#include <array>

namespace nsfd
{
  /** a.b in the frame of a point. */
  template <int dim>
  double product(const std::array<double, dim> &a,
                 const std::array<double, dim> &b)
  {
    double sum = 0.;
    for (unsigned int c = 0; c < dim; ++c)
      sum += a[c] * b[c];
    return sum;
  }

  /** The same without the normal components. */
  template <int dim>
  double tangential_dot(const std::array<double, dim> &a,
                        const std::array<double, dim> &b)
  {
    return product<dim>(a, b) - a[0] * b[0];
  }
} // namespace nsfd
