#include "cauchy_stress.h"

#include "elasticity.h"

#include "nsfd/materials/material_model.h"
#include "nsfd/scene/material_input.h"

#include <cmath>

namespace nsfd
{
  template <int dim>
  std::array<double, 6> cauchy_stress(const MaterialInput &material,
                                      const bool plane_stress,
                                      const double *gradient)
  {
    double F[dim][dim];
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b < dim; ++b)
        F[a][b] = gradient[a * dim + b] + (a == b ? 1. : 0.);
    Voigt<dim> C{}, S{};
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = a; b < dim; ++b)
        for (unsigned int c = 0; c < dim; ++c)
          C[voigt_place<dim>(a, b)] += F[c][a] * F[c][b];
    std::array<double, 6> sigma{};
    const auto elastic =
        material.model->hyperelastic<dim>(material, plane_stress && dim == 2);
    if (!elastic->stress(C, S))
      return sigma;
    const double J = std::sqrt(determinant(C));
    constexpr unsigned int at[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = a; b < dim; ++b)
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            sigma[at[a][b]] +=
                F[a][c] * S[voigt_place<dim>(c, d)] * F[b][d] / J;
    if constexpr (dim == 2)
      if (!plane_stress)
        sigma[2] = material.model->stress_across(
                       LinearElasticity<dim>(material, false).lambda, C) /
                   J;
    return sigma;
  }

  template std::array<double, 6> cauchy_stress<2>(const MaterialInput &, bool,
                                                  const double *);
  template std::array<double, 6> cauchy_stress<3>(const MaterialInput &, bool,
                                                  const double *);
} // namespace nsfd
