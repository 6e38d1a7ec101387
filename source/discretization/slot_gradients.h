#pragma once

#include "body_shape.h"
#include "cell_geometry.h"

#include <deal.II/fe/fe.h>

#include <vector>

namespace nsfd
{
  /** Gradients of the shape functions at the slots of @p shape, slot x node,
   * 1/m (before deformation). */
  template <int dim>
  std::vector<dealii::Tensor<1, dim>>
  slot_gradients(const BodyShape<dim> &shape,
                 const dealii::FiniteElement<dim, dim> &element)
  {
    std::vector<dealii::Tensor<1, dim>> gradients;
    for (const auto &place : shape.slot_places) {
      const auto inverse =
          invert(jacobian(shape.reference, shape.corners, place));
      for (unsigned int i = 0; i < shape.n_nodes; ++i)
        gradients.push_back(transpose(inverse) * element.shape_grad(i, place));
    }
    return gradients;
  }
} // namespace nsfd
