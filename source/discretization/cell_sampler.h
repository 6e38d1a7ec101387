#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <array>
#include <vector>

namespace dealii
{
  template <int dim, int spacedim>
  class FiniteElement;
} // namespace dealii

namespace nsfd
{
  using Vector3 = std::array<double, 3>;

  template <int dim, typename Vector>
  Vector3 in_space(const Vector &x)
  {
    Vector3 result{};
    for (unsigned int c = 0; c < dim; ++c)
      result[c] = x[c];
    return result;
  }

  double von_mises(const std::array<double, 6> &stress);

  /** From the order of deal.II to the cyclic one of VTK. */
  std::vector<unsigned int> cyclic(unsigned int n_corners);

  /** Values and gradients at the same reference points of every body. */
  template <int dim>
  class Sampler
  {
  public:
    Sampler(const dealii::FiniteElement<dim, dim> &element,
            const std::vector<dealii::Point<dim>> &points);

    dealii::Point<dim>
    position(unsigned int q,
             const std::vector<dealii::Point<dim>> &corners) const;

    /** @p u: nodal values of the body. */
    dealii::Tensor<1, dim> value(unsigned int q, const double *u) const;

    /** Of what is linear between the corners, one value each. */
    double linear_value(unsigned int q, const double *corners) const;

    /** [component][direction] */
    std::array<double, dim * dim>
    gradient(unsigned int q, const std::vector<dealii::Point<dim>> &corners,
             const double *u) const;

  private:
    unsigned int n_nodes_, n_corners_;
    std::vector<double> values_, linear_values_;
    std::vector<dealii::Tensor<1, dim>> gradients_, linear_gradients_;
  };
} // namespace nsfd
