#pragma once

#include "body_shape.h"

#include "mesh/cell_set.h"

#include <deal.II/fe/fe.h>

#include <map>
#include <memory>
#include <vector>

namespace dealii
{
  template <int dim, int spacedim>
  class Triangulation;
} // namespace dealii

namespace nsfd
{
  struct AbsorbingFace;

  /** The cells that a rank looks at: bodies, classes, places and nodes. */
  template <int dim>
  struct Cells {
    /**
     * @p materials by active_cell_index. Shapes are rounded to 2^-42 of their
     * size before they are compared and before anything is computed from them.
     * Constants of a graded material that cannot be are replaced by others: see
     * `graded`. Those of @p absorbing faces have dashpots, but for explicit
     * steps at nodes.
     */
    Cells(const dealii::Triangulation<dim, dim> &triangulation,
          const std::vector<unsigned int> &materials, const SceneInput &input,
          CellSet set, const std::vector<AbsorbingFace> &absorbing);

    std::unique_ptr<dealii::FiniteElement<dim, dim>> element;
    Bodies bodies;                      ///< without points
    std::vector<BodyShape<dim>> shapes; ///< per class, see class_shape()
    std::vector<std::vector<dealii::Point<dim>>> corners; ///< as in deal.II
    std::vector<std::size_t> first_node;                  ///< size n + 1
    std::vector<unsigned long long> global_cell;
    unsigned long long n_global = 0;                  ///< cells of all ranks
    std::vector<std::array<unsigned int, 4>> cell_id; ///< CellId::to_binary(),
                                                      ///< alike on all ranks

    /// of every material that varies, the smallest and the largest constants on
    /// this rank; -infinity: one is not a number somewhere
    std::map<unsigned int, std::array<LocalModuli, 2>> graded;
    /// by material, the id of the first cell here that has no Euler angles
    std::map<unsigned int, unsigned int> without_orientation;

    ShapeOfBody<dim> shape(const std::size_t body) const
    {
      return shape(body, corners[body]);
    }
    /** What it would be with other corners, if bodies differ(). */
    ShapeOfBody<dim> shape(std::size_t body,
                           const std::vector<dealii::Point<dim>> &at) const;
    /** What all bodies of its class have, and its corners but for those. */
    const BodyShape<dim> &class_shape(const std::size_t body) const
    {
      return shapes[bodies.class_of[body]];
    }
    /** Bodies of a class differ in their corners, and have no blocks. */
    bool differ() const { return builder_->has_no_blocks(); }
    const BodyClass &body_class(const std::size_t body) const
    {
      return bodies.classes[bodies.class_of[body]];
    }
    /** From a place relative to corner 0. */
    dealii::Point<dim> place(const std::size_t body,
                             const dealii::Point<dim> &relative) const
    {
      return corners[body][0] + dealii::Tensor<1, dim>(relative);
    }
    dealii::Point<dim> centre(const std::size_t body) const
    {
      return place(body,
                   differ() ? mean_of_corners(body) : class_shape(body).centre);
    }
    /** m^3, or m^2 in the plane. */
    double volume(const std::size_t body) const
    {
      return differ() ? volume_of_simplex(body) : class_shape(body).volume;
    }
    /** Values of a nodal vector at the corners, dim each. */
    std::vector<double> at_corners(std::size_t body,
                                   const std::vector<double> &nodal) const;
    /** Entries of nodal vectors: node-major, dim components, all cells. */
    std::size_t n_nodal() const { return first_node.back() * dim; }

  private:
    dealii::Point<dim> mean_of_corners(std::size_t body) const;
    double volume_of_simplex(std::size_t body) const;

    std::unique_ptr<const ClassBuilder<dim>> builder_;
    mutable std::vector<typename ShapeOfBody<dim>::Spare>
        spare_shapes_; ///< by class
  };
} // namespace nsfd
