#pragma once

#include "body_shape.h"

#include <algorithm>
#include <array>
#include <vector>

// Axisymmetric scenes: x is the radius, and the axis is at x = 0.

namespace nsfd
{
  struct DiscretizationInput;

  /** A face of a triangulation that has no area: where bodies are full. */
  template <typename Face>
  bool is_on_axis(const Face &face)
  {
    double largest = 0.;
    for (const unsigned int v : face->vertex_indices())
      largest = std::max(largest, face->vertex(v)[0]);
    return largest < axis_tolerance * face->measure();
  }

  /** u_r / r at @p x, on the axis du_r/dr, in cells of this size. */
  template <int dim>
  double hoop_strain(const dealii::Point<dim> &x, const double *value,
                     const double *gradient, const double cell_size)
  {
    return x[0] > axis_tolerance * cell_size ? value[0] / x[0] : gradient[0];
  }

  /**
   * What the measure of point @p q of a face is times, whose points have these
   * @p radii. Where they are the two nodes of a straight face, the mean of r
   * weighted by the polynomial of the node: with the radius itself one on the
   * axis would have no area, and it has a mass.
   */
  inline double radius_of_point(const std::vector<double> &radii,
                                const std::size_t q, const bool at_nodes)
  {
    return at_nodes && radii.size() == 2 ? (2. * radii[q] + radii[1 - q]) / 3.
                                         : radii[q];
  }

  /** Of an axisymmetric scene: the points from @p first on, which are those of
      one face with the weights of the half-plane. */
  template <int dim>
  void weigh_rings(const DiscretizationInput &input, std::size_t first,
                   InterfacePoints<dim> &points);

  /**
   * r makes integrands one degree higher, and u_r^2 / r is no polynomial: one
   * point more than the @p n per direction of other scenes.
   */
  template <int dim>
  dealii::Quadrature<dim> ring_quadrature(const dealii::ReferenceCell &cell,
                                          unsigned int n);

  /** The gradient of a displacement of a ring in space, 3 x 3, from that in the
      plane. */
  inline std::array<double, 9> with_hoop(const double *gradient,
                                         const double hoop)
  {
    return {{gradient[0], gradient[1], 0., gradient[2], gradient[3], 0., 0., 0.,
             hoop}};
  }

  /** u_r / r at a place of the cell of a radial motion of one node, whose
      shape function has this @p value and @p gradient there, 1/m. */
  template <int dim>
  double hoop_of_node(const BodyShape<dim> &shape,
                      const dealii::Point<dim> &relative, const double value,
                      const dealii::Tensor<1, dim> &gradient)
  {
    const double r = radius_at(shape, relative);
    return r > axis_tolerance * shape.height ? value / r : gradient[0];
  }

  /** The only rigid one, by node and component. */
  template <int dim>
  Block motion_along_axis(const BodyShape<dim> &shape)
  {
    Block along(shape.n_nodes * dim, 1);
    for (unsigned int i = 0; i < shape.n_nodes; ++i)
      along(i * dim + 1, 0) = 1.;
    return along;
  }

  /** Radial motions of nodes @p on_axis take part in nothing: of a field with
      dim values per node. */
  template <int dim>
  void hold_nodes(const std::vector<char> &on_axis, double *nodal)
  {
    for (std::size_t i = 0; i < on_axis.size(); ++i)
      if (on_axis[i])
        nodal[i * dim] = 0.;
  }

  /** The same of the columns of a block. */
  template <int dim>
  void hold_columns(const BodyShape<dim> &shape, Block &block)
  {
    for (unsigned int i = 0; i < shape.on_axis.size(); ++i)
      for (unsigned int k = 0; shape.on_axis[i] && k < block.rows; ++k)
        block(k, i * dim) = 0.;
  }

  /** The same of a matrix, which stays positive definite: the diagonal is
      that of the motion along the axis, so that no frequency is higher. */
  template <int dim>
  void hold_unknowns(const BodyShape<dim> &shape, Block &matrix)
  {
    for (unsigned int i = 0; i < shape.on_axis.size(); ++i) {
      const unsigned int held = i * dim;
      for (unsigned int k = 0; shape.on_axis[i] && k < matrix.rows; ++k)
        matrix(held, k) = matrix(k, held) =
            k == held ? matrix(held + 1, held + 1) : 0.;
    }
  }
} // namespace nsfd
