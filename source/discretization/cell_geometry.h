#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>
#include <deal.II/grid/reference_cell.h>

#include <boost/container/small_vector.hpp>

#include <array>
#include <vector>

namespace nsfd
{
  /**
   * Geometry of straight-sided cells from their corners in deal.II's order,
   * without a mesh: what MappingQ(1) would say.
   */

  /** Of linear shape function @p v; deal.II 9.4.1 has none for tetrahedra. */
  template <int dim>
  dealii::Tensor<1, dim> linear_gradient(const dealii::ReferenceCell &cell,
                                         const dealii::Point<dim> &xi,
                                         unsigned int v);

  /** x = sum of linear shape functions times corners. */
  template <int dim>
  dealii::Point<dim> map_point(const dealii::ReferenceCell &cell,
                               const std::vector<dealii::Point<dim>> &corners,
                               const dealii::Point<dim> &xi);

  /** dx_i/dxi_j. */
  template <int dim>
  dealii::Tensor<2, dim>
  jacobian(const dealii::ReferenceCell &cell,
           const std::vector<dealii::Point<dim>> &corners,
           const dealii::Point<dim> &xi);

  /** The corners of a face out of those of its cell. */
  template <int dim>
  std::vector<dealii::Point<dim>>
  face_corners(const dealii::ReferenceCell &cell,
               const std::vector<dealii::Point<dim>> &corners,
               unsigned int face_no);

  template <int dim>
  dealii::Point<dim> mean(const std::vector<dealii::Point<dim>> &points);

  /** A face of a cell: its corners give positions, normals and measures. */
  template <int dim>
  class FaceGeometry
  {
  public:
    FaceGeometry(const dealii::ReferenceCell &cell,
                 const std::vector<dealii::Point<dim>> &cell_corners,
                 unsigned int face_no);

    using Corners = boost::container::small_vector<dealii::Point<dim>, 4>;

    bool is_triangle() const;
    const Corners &corners() const { return corners_; }
    /** Mean of its corners. */
    dealii::Point<dim> centre() const;

    dealii::Point<dim> position(const dealii::Point<dim - 1> &xi) const
    {
      return at(corners_, xi);
    }
    dealii::Point<dim> in_reference_cell(const dealii::Point<dim - 1> &xi) const
    {
      return at(reference_, xi);
    }
    /** Outward normal times the measure ratio. */
    dealii::Tensor<1, dim> normal(const dealii::Point<dim - 1> &xi) const;

    /** Length or area. */
    double measure() const;

  private:
    dealii::Point<dim> at(const Corners &of,
                          const dealii::Point<dim - 1> &xi) const;

    dealii::ReferenceCell face_;
    Corners corners_, reference_; ///< in space, in the reference cell
    dealii::Point<dim> inside_;   ///< centre of the cell
  };

  /** Rows n, t1, t2 of a right-handed local frame. */
  template <int dim>
  std::array<dealii::Tensor<1, dim>, dim>
  local_frame(const dealii::Tensor<1, dim> &n);
} // namespace nsfd
