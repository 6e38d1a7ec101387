#include "elasticity.h"

#include "anisotropy.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  template <int dim>
  LocalModuli local_moduli(const MaterialInput &material,
                           const dealii::Point<dim> &x, const unsigned int id)
  {
    LocalModuli local;
    if (material.anisotropic) {
      std::array<double, 3> place{};
      for (unsigned int d = 0; d < dim; ++d)
        place[d] = x[d];
      local.orientation =
          orientation_at(material.anisotropic->orientation, place, id);
      local.density =
          material.graded ? material.graded->density.at(x) : material.density;
      return local;
    }
    if (!material.graded)
      return {material.young, material.poisson, material.density};
    const GradedInput &graded = *material.graded;
    return {graded.young.at(x), graded.poisson.at(x), graded.density.at(x)};
  }

  LocalModuli local_moduli(const MaterialInput &material)
  {
    return material.anisotropic ? local_moduli(material, dealii::Point<3>(), 0)
                                : LocalModuli{material.young, material.poisson,
                                              material.density};
  }

  template <int dim>
  LinearElasticity<dim>::LinearElasticity(const MaterialInput &material,
                                          const bool plane_stress)
      : LinearElasticity(material, local_moduli(material), plane_stress)
  {
  }

  template <int dim>
  LinearElasticity<dim>::LinearElasticity(const MaterialInput &material,
                                          const LocalModuli &local,
                                          const bool plane_stress)
      : plane_stress_(dim == 2 && plane_stress), density_(local.density)
  {
    if (material.transverse)
      set_transverse(material);
    else if (material.anisotropic)
      set_matrix(*material.anisotropic, local.orientation);
    else
      set_isotropic(local.young, local.poisson);
  }

  template <int dim>
  LinearElasticity<dim>
  LinearElasticity<dim>::viscous(const MaterialInput &material)
  {
    LinearElasticity result;
    result.mu = material.shear_viscosity;
    result.lambda = result.lambda_zz_ =
        material.bulk_viscosity - 2. / 3. * material.shear_viscosity;
    return result;
  }

  template <int dim>
  void LinearElasticity<dim>::set_isotropic(const double E, const double nu)
  {
    mu = E / (2. * (1. + nu));
    lambda = plane_stress_ ? E * nu / (1. - nu * nu)
                           : E * nu / ((1. + nu) * (1. - 2. * nu));
    lambda_zz_ = lambda;
    const double modulus = plane_stress_
                               ? E / (1. - nu * nu)
                               : E * (1. - nu) / ((1. + nu) * (1. - 2. * nu));
    speeds_ = {{std::sqrt(E / (2. * (1. + nu)) / density_),
                std::sqrt(modulus / density_)}};
    stiffest_ = softest_ = {E, nu};
  }

  /**
   * The five constants to those of the class: with the axis along 1, the
   * entries C_11, C_12, C_22, C_23 of Hooke's matrix; in plane stress the
   * strain normal to the plane is what makes its stress zero.
   */
  template <int dim>
  void LinearElasticity<dim>::set_transverse(const MaterialInput &material)
  {
    const TransverseInput &input = *material.transverse;
    const double E_A = input.axial_young, E_T = input.transverse_young,
                 nu_A = input.axial_poisson, nu_T = input.transverse_poisson,
                 n = nu_A * nu_A * E_T / E_A, D = 1. - nu_T - 2. * n;
    const double C_11 = E_A * (1. - nu_T) / D, C_12 = nu_A * E_T / D,
                 C_22 = E_T * (1. - n) / ((1. + nu_T) * D),
                 C_23 = E_T * (nu_T + n) / ((1. + nu_T) * D);
    mu = E_T / (2. * (1. + nu_T));
    stiffest_ = {E_A, std::abs(nu_A) * std::sqrt(E_T / E_A)};
    softest_ = {E_T, nu_T};
    if (E_A < E_T)
      std::swap(stiffest_, softest_);
    if (dim == 2 && input.axis[2] != 0.) {
      lambda = plane_stress_ ? C_23 - C_12 * C_12 / C_11 : C_23;
      lambda_zz_ = C_12;
      speeds_ = {
          {std::sqrt(mu / density_), std::sqrt((lambda + 2. * mu) / density_)}};
      return;
    }
    symmetry_ = Symmetry::axial;
    for (unsigned int c = 0; c < dim; ++c)
      axis_[c] = input.axis[c];
    lambda = lambda_zz_ = C_23;
    alpha_ = C_12 - C_23;
    delta_ = input.axial_shear - mu;
    beta_ = C_11 + C_22 - 2. * C_12 - 4. * input.axial_shear;
    if (plane_stress_) {
      const double before = lambda;
      lambda -= before * before / C_22;
      beta_ -= alpha_ * alpha_ / C_22;
      alpha_ -= before * alpha_ / C_22;
    }
    set_speeds_about_axis();
  }

  namespace
  {
    /**
     * The smallest and the largest of the @p roots, ascending pairs, of an
     * angle between 0 and @p range: by a scan and golden sections.
     */
    template <typename Roots>
    std::array<double, 2> extremes_of(const double range, const Roots &roots)
    {
      constexpr unsigned int n = 180;
      const double spacing = range / n;
      // the largest value of sign * root k
      const auto extreme = [&](const unsigned int k, const double sign) {
        const auto value = [&](const double phi) {
          return sign * roots(phi)[k];
        };
        double best = 0.;
        for (unsigned int i = 1; i <= n; ++i)
          if (value(i * spacing) > value(best))
            best = i * spacing;
        const double section = (std::sqrt(5.) - 1.) / 2.;
        double low = best - spacing, high = best + spacing;
        for (unsigned int i = 0; i < 60; ++i) {
          const double width = section * (high - low);
          if (value(high - width) > value(low + width))
            high = low + width;
          else
            low = high - width;
        }
        return sign * std::max(value(best), value((low + high) / 2.));
      };
      return {{extreme(0, -1.), extreme(1, 1.)}};
    }
  } // namespace

  /**
   * Waves that run at the angle phi to the axis: in the plane of both their
   * speeds are the roots of a matrix of 2 x 2, across it (in space) the shear
   * moduli add up. The extremes over phi by a scan and golden sections.
   */
  template <int dim>
  void LinearElasticity<dim>::set_speeds_about_axis()
  {
    const double shear = mu + delta_,
                 C_11 = lambda + 2. * mu + 2. * alpha_ + 4. * delta_ + beta_,
                 C_22 = lambda + 2. * mu, C_12 = lambda + alpha_;
    const auto roots = [&](const double phi) {
      const double c = std::cos(phi), s = std::sin(phi);
      const double a = C_11 * c * c + shear * s * s,
                   b = shear * c * c + C_22 * s * s, d = (C_12 + shear) * c * s;
      const double mean = (a + b) / 2., radius = std::hypot((a - b) / 2., d);
      return std::array<double, 2>{{mean - radius, mean + radius}};
    };
    const double pi = std::acos(-1.);
    auto [slowest, fastest] = extremes_of(pi / 2., roots);
    if (dim == 3)
      slowest = std::min({slowest, mu, shear});
    speeds_ = {{std::sqrt(slowest / density_), std::sqrt(fastest / density_)}};
  }

  template <int dim>
  void
  LinearElasticity<dim>::set_matrix(const AnisotropicInput &input,
                                    const std::array<double, 3> &orientation)
  {
    symmetry_ = Symmetry::none;
    HookeMatrix C = turned(input.stiffness, orientation);
    auto matrix = std::make_shared<Matrix>();
    if (plane_stress_)
      for (const unsigned int k : {2u, 4u, 5u}) { // one strain after the other
        const HookeMatrix before = C;
        for (unsigned int i = 0; i < 6; ++i)
          for (unsigned int j = 0; j < 6; ++j)
            C[i][j] -= before[i][k] * before[k][j] / before[k][k];
      }
    constexpr unsigned int from[] = {0, 1, 3};
    for (unsigned int i = 0; i < n_strains; ++i) {
      for (unsigned int j = 0; j < n_strains; ++j)
        matrix->C[i][j] = dim == 2 ? C[from[i % 3]][from[j % 3]] : C[i][j];
      matrix->across[i] = dim == 2 && !plane_stress_ ? C[2][from[i % 3]] : 0.;
    }
    double normal = 0., all = 0.; // C_aabb and C_abab
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b < dim; ++b) {
        normal += matrix->C[a][b];
        all += matrix->C[place(a, b)][place(a, b)];
      }
    mu = (dim * all - normal) / (dim * (dim - 1) * (dim + 2));
    lambda = (normal - 2. * dim * mu) / (dim * dim);
    lambda_zz_ = lambda;
    matrix_ = matrix;
    stiffest_ = {input.stiffest_young, input.stiffest_poisson};
    softest_ = {input.softest_young, input.softest_poisson};
    if (dim == 3)
      speeds_ = {{std::sqrt(input.slowest / density_),
                  std::sqrt(input.fastest / density_)}};
    else
      set_speeds_in_plane();
  }

  /** As set_speeds_about_axis(), over half a turn. */
  template <int dim>
  void LinearElasticity<dim>::set_speeds_in_plane()
  {
    const auto roots = [this](const double phi) {
      dealii::Tensor<1, dim> direction;
      direction[0] = std::cos(phi);
      direction[1] = std::sin(phi);
      const double a = matrix_coupling(0, 0, direction, direction),
                   b = matrix_coupling(1, 1, direction, direction),
                   d = matrix_coupling(0, 1, direction, direction);
      const double mean = (a + b) / 2., radius = std::hypot((a - b) / 2., d);
      return std::array<double, 2>{{mean - radius, mean + radius}};
    };
    const auto [slowest, fastest] = extremes_of(std::acos(-1.), roots);
    speeds_ = {{std::sqrt(slowest / density_), std::sqrt(fastest / density_)}};
  }

  template <int dim>
  double LinearElasticity<dim>::modulus(const unsigned int a,
                                        const unsigned int b,
                                        const unsigned int c,
                                        const unsigned int d) const
  {
    dealii::Tensor<1, dim> g, h;
    g[b] = h[d] = 1.;
    return coupling(a, c, g, h);
  }

  template <int dim>
  std::array<double, 6>
  LinearElasticity<dim>::stress(const double *gradient) const
  {
    std::array<double, 6> sigma{};
    if (symmetry_ == Symmetry::none) {
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b) {
          const double strain = gradient[a * dim + b];
          for (unsigned int i = 0; i < n_strains; ++i)
            sigma[i < dim ? i : i + 3 - dim] +=
                matrix_->C[i][place(a, b)] * strain;
          if (dim == 2)
            sigma[2] += matrix_->across[place(a, b)] * strain;
        }
      return sigma;
    }
    double trace = 0.;
    for (unsigned int c = 0; c < dim; ++c)
      trace += gradient[c * dim + c];
    for (unsigned int c = 0; c < dim; ++c)
      sigma[c] = lambda * trace + 2. * mu * gradient[c * dim + c];
    if (dim == 2 && !plane_stress_)
      sigma[2] = lambda_zz_ * trace;
    sigma[3] = mu * (gradient[1] + gradient[dim]);
    if (dim == 3) {
      sigma[4] = mu * (gradient[2] + gradient[2 * dim]);
      sigma[5] = mu * (gradient[dim + 2] + gradient[2 * dim + 1]);
    }
    if (symmetry_ == Symmetry::isotropic)
      return sigma;
    std::array<double, dim> across{}; // e a
    double along = 0.;
    for (unsigned int c = 0; c < dim; ++c) {
      for (unsigned int d = 0; d < dim; ++d)
        across[c] +=
            (gradient[c * dim + d] + gradient[d * dim + c]) / 2. * axis_[d];
      along += axis_[c] * across[c];
    }
    constexpr unsigned int at[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    for (unsigned int c = 0; c < dim; ++c) {
      sigma[c] += alpha_ * along;
      for (unsigned int d = c; d < dim; ++d)
        sigma[at[c][d]] +=
            (alpha_ * trace + beta_ * along) * axis_[c] * axis_[d] +
            2. * delta_ * (axis_[c] * across[d] + across[c] * axis_[d]);
    }
    if (dim == 2 && !plane_stress_)
      sigma[2] += alpha_ * along;
    return sigma;
  }

  template <int dim>
  void LinearElasticity<dim>::add_hoop(const double strain,
                                       std::array<double, 6> &stress) const
  {
    for (unsigned int c = 0; c < 3; ++c)
      stress[c] += lambda * strain;
    stress[2] += 2. * mu * strain;
  }

  template <int dim>
  MaterialExtremes LinearElasticity<dim>::extremes() const
  {
    return {stiffest_, softest_, speeds_[1], speeds_[0], density_};
  }

  void widen(const MaterialExtremes &one, MaterialExtremes &all)
  {
    const bool first = all.fastest == 0.;
    if (first || one.stiffest.young > all.stiffest.young)
      all.stiffest = one.stiffest;
    if (first || one.softest.young < all.softest.young)
      all.softest = one.softest;
    all.slowest = first ? one.slowest : std::min(all.slowest, one.slowest);
    all.fastest = std::max(all.fastest, one.fastest);
    all.densest = std::max(all.densest, one.densest);
  }

  template LocalModuli local_moduli<2>(const MaterialInput &,
                                       const dealii::Point<2> &, unsigned int);
  template LocalModuli local_moduli<3>(const MaterialInput &,
                                       const dealii::Point<3> &, unsigned int);
  template class LinearElasticity<2>;
  template class LinearElasticity<3>;
} // namespace nsfd
