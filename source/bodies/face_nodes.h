#pragma once

#include "discretization/body_shape.h"

#include <deal.II/fe/fe.h>

#include <vector>

namespace nsfd
{
  /** The nodes on one face of a cell, and flat pieces between them. */
  template <int dim>
  struct FaceNodes {
    std::vector<unsigned int> nodes; ///< of the cell
    std::vector<double> weights;     ///< of these nodes, m or m^2
    /// dim nodes of the cell each, 4 of a quadrilateral; the outside as in
    /// Surfaces
    std::vector<std::vector<unsigned int>> pieces;
    dealii::Tensor<1, dim> normal; ///< outward at rest, of the first piece

    /** To and from another rank. */
    template <typename Archive>
    void serialize(Archive &archive, const unsigned int)
    {
      archive &nodes &weights &pieces &normal;
    }
  };

  /** Of all faces of a cell. */
  template <int dim>
  std::vector<FaceNodes<dim>>
  face_nodes(const dealii::FiniteElement<dim, dim> &element,
             const BodyShape<dim> &shape);
} // namespace nsfd
