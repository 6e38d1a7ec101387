#pragma once

#include "make_scene.h"

#include <array>
#include <cmath>
#include <vector>

namespace nsfd::test
{
  using Vec = std::array<double, 3>;

  /** Linear and angular momentum about the origin, of nodal masses. */
  template <int dim>
  std::array<Vec, 2> momenta(const Scene<dim> &scene)
  {
    std::array<Vec, 2> result{};
    const auto &d = *scene.discretization;
    std::vector<double> x(scene.state.displacement);
    const auto rest = d.interpolate(
        [](const dealii::Point<dim> &place, unsigned int, double *values) {
          for (unsigned int c = 0; c < dim; ++c)
            values[c] = place[c];
        });
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] += rest[i];
    const auto &bodies = d.bodies();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const Block &M = bodies.classes[bodies.class_of[b]].mass;
      const std::size_t first = bodies.first_dof[b];
      for (unsigned int i = 0; i < M.rows; i += dim)
        for (unsigned int j = 0; j < M.rows; j += dim) {
          Vec at{}, v{};
          for (unsigned int c = 0; c < dim; ++c) {
            at[c] = x[first + i + c];
            v[c] = scene.state.velocity[first + j + c];
            result[0][c] += M(i, j) * v[c];
          }
          const double m = M(i, j);
          result[1][0] += m * (at[1] * v[2] - at[2] * v[1]);
          result[1][1] += m * (at[2] * v[0] - at[0] * v[2]);
          result[1][2] += m * (at[0] * v[1] - at[1] * v[0]);
        }
    }
    return result;
  }

  inline double norm(const Vec &a)
  {
    return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  }

  inline Vec difference(const Vec &a, const Vec &b)
  {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  }
} // namespace nsfd::test
