#pragma once

#include "nsfd/scene/scene_input.h"

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
      for (unsigned int c = 0; c < dim; ++c) {
        centre_[c] = input.point[c] + (shift ? shift[c] : 0.);
        axis_[c] = input.normal[c];
      }
    }

    /** Out of the obstacle, of unit length. */
    dealii::Tensor<1, dim> normal(const dealii::Point<dim> &x) const
    {
      if (input_.shape == ObstacleShape::plane)
        return axis_;
      const auto r = radial(x);
      const double length = r.norm();
      if (length == 0.) { // at the centre: any direction is as good
        dealii::Tensor<1, dim> any;
        any[dim - 1] = 1.;
        return any;
      }
      return (input_.hollow ? -1. : 1.) / length * r;
    }

    /** Negative inside. */
    double gap(const dealii::Point<dim> &x) const
    {
      if (input_.shape == ObstacleShape::plane)
        return axis_ * (x - centre_);
      const double distance = radial(x).norm() - input_.radius;
      return input_.hollow ? -distance : distance;
    }

  private:
    dealii::Tensor<1, dim> radial(const dealii::Point<dim> &x) const
    {
      dealii::Tensor<1, dim> r = x - centre_;
      if (input_.shape == ObstacleShape::cylinder)
        r -= (r * axis_) * axis_;
      return r;
    }

    const ObstacleInput &input_;
    dealii::Point<dim> centre_;
    dealii::Tensor<1, dim> axis_;
  };
} // namespace nsfd
