#include "cell_sampler.h"

#include "cell_geometry.h"

#include <deal.II/fe/fe.h>

#include <cmath>
#include <numeric>

namespace nsfd
{
  using namespace dealii;

  double von_mises(const std::array<double, 6> &s)
  {
    const double xy = s[0] - s[1], yz = s[1] - s[2], zx = s[2] - s[0];
    return std::sqrt((xy * xy + yz * yz + zx * zx) / 2. +
                     3. * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
  }

  std::vector<unsigned int> cyclic(const unsigned int n_corners)
  {
    switch (n_corners) {
    case 4:
      return {0, 1, 3, 2};
    case 8:
      return {0, 1, 3, 2, 4, 5, 7, 6};
    default:
      std::vector<unsigned int> order(n_corners);
      std::iota(order.begin(), order.end(), 0);
      return order;
    }
  }

  template <int dim>
  Sampler<dim>::Sampler(const FiniteElement<dim, dim> &element,
                        const std::vector<Point<dim>> &points)
      : n_nodes_(element.n_dofs_per_cell()),
        n_corners_(element.reference_cell().n_vertices())
  {
    const ReferenceCell cell = element.reference_cell();
    for (const auto &xi : points) {
      for (unsigned int i = 0; i < n_nodes_; ++i) {
        values_.push_back(element.shape_value(i, xi));
        gradients_.push_back(element.shape_grad(i, xi));
      }
      for (unsigned int v = 0; v < n_corners_; ++v) {
        linear_values_.push_back(cell.d_linear_shape_function(xi, v));
        linear_gradients_.push_back(linear_gradient(cell, xi, v));
      }
    }
  }

  template <int dim>
  Point<dim>
  Sampler<dim>::position(const unsigned int q,
                         const std::vector<Point<dim>> &corners) const
  {
    Point<dim> x;
    for (unsigned int v = 0; v < n_corners_; ++v)
      x += linear_values_[q * n_corners_ + v] * corners[v];
    return x;
  }

  template <int dim>
  double Sampler<dim>::linear_value(const unsigned int q,
                                    const double *corners) const
  {
    double value = 0.;
    for (unsigned int v = 0; v < n_corners_; ++v)
      value += linear_values_[q * n_corners_ + v] * corners[v];
    return value;
  }

  template <int dim>
  Tensor<1, dim> Sampler<dim>::value(const unsigned int q,
                                     const double *u) const
  {
    Tensor<1, dim> result;
    for (unsigned int i = 0; i < n_nodes_; ++i)
      for (unsigned int c = 0; c < dim; ++c)
        result[c] += values_[q * n_nodes_ + i] * u[i * dim + c];
    return result;
  }

  template <int dim>
  std::array<double, dim * dim>
  Sampler<dim>::gradient(const unsigned int q,
                         const std::vector<Point<dim>> &corners,
                         const double *u) const
  {
    Tensor<2, dim> jacobian, reference;
    for (unsigned int v = 0; v < n_corners_; ++v)
      jacobian += outer_product(Tensor<1, dim>(corners[v] - corners[0]),
                                linear_gradients_[q * n_corners_ + v]);
    for (unsigned int i = 0; i < n_nodes_; ++i)
      for (unsigned int c = 0; c < dim; ++c)
        reference[c] += u[i * dim + c] * gradients_[q * n_nodes_ + i];
    const Tensor<2, dim> physical = reference * invert(jacobian);
    std::array<double, dim * dim> result;
    for (unsigned int c = 0; c < dim; ++c)
      for (unsigned int d = 0; d < dim; ++d)
        result[c * dim + d] = physical[c][d];
    return result;
  }

  template class Sampler<2>;
  template class Sampler<3>;
} // namespace nsfd
