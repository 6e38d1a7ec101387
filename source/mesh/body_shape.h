#pragma once

#include "nsfd/dynamics/bodies.h"

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>
#include <deal.II/grid/reference_cell.h>

#include <vector>

namespace dealii
{
  template <int dim, int spacedim>
  class FiniteElement;
} // namespace dealii

namespace nsfd
{
  struct SceneInput;

  /**
   * What the bodies of one class share besides their blocks: tables of the
   * cell with its corner 0 at the origin.
   */
  template <int dim>
  struct BodyShape {
    dealii::ReferenceCell reference;
    std::vector<dealii::Point<dim>> corners;
    unsigned int divided = 0; ///< bit f: there are smaller cells behind face f
    unsigned int n_nodes = 0;
    std::vector<dealii::Point<dim>> nodes;
    // cell quadrature: positions, JxW, values and gradients (point x node)
    std::vector<dealii::Point<dim>> positions;
    std::vector<double> JxW;
    std::vector<double> values;
    std::vector<dealii::Tensor<1, dim>> gradients;
    std::vector<dealii::Point<dim>> slot_positions;
    std::vector<dealii::Tensor<1, dim>> slot_normals; ///< outward, times w
    std::vector<dealii::Point<dim>> slot_places; ///< in the reference cell
    std::vector<unsigned int> slot_faces;
    std::vector<double> corner_values; ///< corner x node
    double volume = 0.;
    dealii::Point<dim> centre;
    double height = 0.; ///< way of a wave through the cell
    Block modes;        ///< rigid: nodal values = modes * unknowns
    Block projection;   ///< rigid: unknowns = projection * nodal values
    Block nodal_mass;   ///< rigid: of the nodal values
  };

  /**
   * Shape and blocks of a class from its corners: mass, stiffness, traces at
   * the interface points of every face, face by face; of a divided face
   * (hypercubes only) those of its halves or quarters, one after the other.
   * @p size scales the rotations of a rigid body.
   */
  template <int dim>
  class ClassBuilder
  {
  public:
    ClassBuilder(const dealii::FiniteElement<dim, dim> &element,
                 const SceneInput &input)
        : element_(element), input_(input)
    {
    }

    void build(const dealii::ReferenceCell &reference,
               const std::vector<dealii::Point<dim>> &corners, double size,
               unsigned int material, unsigned int divided,
               BodyShape<dim> &shape, BodyClass &body) const;

  private:
    void set_tables(BodyShape<dim> &shape) const;
    Block mass(const BodyShape<dim> &shape, unsigned int material) const;
    Block stiffness(const BodyShape<dim> &shape, unsigned int material) const;
    /** Also the slots. */
    Block trace(BodyShape<dim> &shape) const;
    /** Traction block and its bound; needs stiffness, motions and slots. */
    void set_traction(const BodyShape<dim> &shape, BodyClass &body) const;

    const dealii::FiniteElement<dim, dim> &element_;
    const SceneInput &input_;
  };
} // namespace nsfd
