#pragma once

#include "nsfd/obstacles/obstacle_shape.h"

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

namespace nsfd
{
  /** Distance and normal of an obstacle that has moved by a shift. */
  template <int dim>
  class ObstacleGeometry
  {
  public:
    ObstacleGeometry(const ObstacleInput &input, const double *shift)
        : input_(input)
    {
      for (unsigned int c = 0; c < dim; ++c)
        centre_[c] = input.point[c] + (shift ? shift[c] : 0.);
    }

    /** Out of the obstacle, of unit length. */
    dealii::Tensor<1, dim> normal(const dealii::Point<dim> &x) const
    {
      const auto n = input_.shape->normal(input_, from_centre(x));
      dealii::Tensor<1, dim> result;
      for (unsigned int c = 0; c < dim; ++c)
        result[c] = n[c];
      if (result.norm_square() == 0.)
        result[dim - 1] = 1.; // any direction is as good
      return result;
    }

    /** Negative inside. */
    double gap(const dealii::Point<dim> &x) const
    {
      return input_.shape->gap(input_, from_centre(x));
    }

  private:
    ObstacleShape::Vector from_centre(const dealii::Point<dim> &x) const
    {
      ObstacleShape::Vector result{};
      for (unsigned int c = 0; c < dim; ++c)
        result[c] = x[c] - centre_[c];
      return result;
    }

    const ObstacleInput &input_;
    dealii::Point<dim> centre_;
  };
} // namespace nsfd
