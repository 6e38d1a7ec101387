#pragma once

#include "discretization/cells.h"

#include <algorithm>
#include <array>
#include <vector>

namespace nsfd
{
  /** What energies and rates of a triangle of degree 1 take, from the shape
     that its cell has in steps. */
  struct LinearTriangle {
    using Values = std::array<double, 6>; ///< two at each corner

    /** Of the material of a body, with its corners or with others. */
    LinearTriangle(const Cells<2> &cells, const std::size_t body,
                   const std::vector<dealii::Point<2>> &at)
    {
      const auto shape = cells.shape(body, at);
      std::copy_n(shape->gradients.begin(), 3, gradients.begin());
      area = shape->volume;
    }
    LinearTriangle(const Cells<2> &cells, const std::size_t body)
        : LinearTriangle(cells, body, cells.corners[body])
    {
    }

    /** xx, yy, xy of the symmetric gradient. */
    std::array<double, 3> strain(const double *u) const
    {
      std::array<double, 3> result{};
      for (unsigned int i = 0; i < 3; ++i) {
        const auto &g = gradients[i];
        result[0] += g[0] * u[2 * i];
        result[1] += g[1] * u[2 * i + 1];
        result[2] += (g[1] * u[2 * i] + g[0] * u[2 * i + 1]) / 2.;
      }
      return result;
    }
    double dilatation(const double *u) const
    {
      const auto e = strain(u);
      return e[0] + e[1];
    }

    std::array<dealii::Tensor<1, 2>, 3> gradients; ///< of its linear functions
    double area = 0.;                              ///< m^2
  };
} // namespace nsfd
