#include "elasticity.h"

#include "nsfd/input/scene_input.h"

#include <cmath>

namespace nsfd
{
  template <int dim>
  LinearElasticity<dim>::LinearElasticity(const MaterialInput &material,
                                          const bool plane_stress)
      : young_(material.young), poisson_(material.poisson),
        density_(material.density), plane_stress_(dim == 2 && plane_stress)
  {
    const double E = young_, nu = poisson_;
    mu = E / (2. * (1. + nu));
    lambda = plane_stress_ ? E * nu / (1. - nu * nu)
                           : E * nu / ((1. + nu) * (1. - 2. * nu));
  }

  template <int dim>
  std::array<double, 6>
  LinearElasticity<dim>::stress(const double *gradient) const
  {
    std::array<double, 6> sigma{};
    double trace = 0.;
    for (unsigned int c = 0; c < dim; ++c)
      trace += gradient[c * dim + c];
    for (unsigned int c = 0; c < dim; ++c)
      sigma[c] = lambda * trace + 2. * mu * gradient[c * dim + c];
    if (dim == 2 && !plane_stress_)
      sigma[2] = lambda * trace;
    sigma[3] = mu * (gradient[1] + gradient[dim]);
    if (dim == 3) {
      sigma[4] = mu * (gradient[2] + gradient[2 * dim]);
      sigma[5] = mu * (gradient[dim + 2] + gradient[2 * dim + 1]);
    }
    return sigma;
  }

  template <int dim>
  double LinearElasticity<dim>::pressure_wave_speed() const
  {
    const double E = young_, nu = poisson_;
    const double modulus = plane_stress_
                               ? E / (1. - nu * nu)
                               : E * (1. - nu) / ((1. + nu) * (1. - 2. * nu));
    return std::sqrt(modulus / density_);
  }

  template <int dim>
  double LinearElasticity<dim>::shear_wave_speed() const
  {
    return std::sqrt(young_ / (2. * (1. + poisson_)) / density_);
  }

  template class LinearElasticity<2>;
  template class LinearElasticity<3>;
} // namespace nsfd
