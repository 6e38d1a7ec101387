#include "axis.h"

#include "nsfd/scene/scene_input.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe.h>

#include <algorithm>
#include <vector>

// What is different in the shape and the blocks of a ring.

namespace nsfd
{
  using namespace dealii;

  template <int dim>
  Quadrature<dim> ring_quadrature(const ReferenceCell &cell,
                                  const unsigned int n)
  {
    if (cell.is_simplex())
      return QWitherdenVincentSimplex<dim>(n + 1);
    return QGauss<dim>(n + 1);
  }

  template <int dim>
  void weigh_rings(const DiscretizationInput &input, const std::size_t first,
                   InterfacePoints<dim> &points)
  {
    const bool at_nodes = input.interface_quadrature == "gauss lobatto";
    std::vector<double> radii;
    for (std::size_t i = first; i < points.n_points; ++i)
      radii.push_back(points.position[i * dim]);
    for (std::size_t q = 0; q < radii.size(); ++q) {
      double &weight = points.weight[first + q];
      points.lengths.push_back(weight);
      weight *= radius_of_point(radii, q, at_nodes);
    }
  }

  /** Height and centre are those in the half-plane. */
  template <int dim>
  void ClassBuilder<dim>::set_axis(BodyShape<dim> &shape) const
  {
    shape.volume = 0.;
    for (unsigned int q = 0; q < shape.JxW.size(); ++q) {
      shape.JxW[q] *= radius_at(shape, shape.positions[q]);
      shape.volume += shape.JxW[q];
    }
    for (const Point<dim> &node : shape.nodes)
      shape.on_axis.push_back(radius_at(shape, node) <
                              axis_tolerance * shape.height);
  }

  /**
   * With the hoop strain h_i = N_i / r of a radial motion and the divergence
   * g_i + h_i: lambda (g_i h_j + h_i g_j + h_i h_j) + 2 mu h_i h_j, of the
   * lower half.
   */
  template <int dim>
  void
  ClassBuilder<dim>::add_hoop(const BodyShape<dim> &shape,
                              const std::vector<LinearElasticity<dim>> &local,
                              Block &stiffness) const
  {
    const unsigned int n = shape.n_nodes;
    std::vector<double> hoop(n * dim, 0.), in_plane(n * dim);
    for (unsigned int q = 0; q < shape.JxW.size(); ++q) {
      const double r = radius_at(shape, shape.positions[q]);
      for (unsigned int i = 0; i < n; ++i) {
        hoop[i * dim] = shape.values[q * n + i] / r;
        for (unsigned int c = 0; c < dim; ++c)
          in_plane[i * dim + c] = shape.gradients[q * n + i][c];
      }
      const auto &law = at_place(local, q);
      for (unsigned int i = 0; i < n * dim; ++i)
        for (unsigned int j = 0; j <= i; ++j)
          stiffness(i, j) +=
              shape.JxW[q] *
              (law.lambda * (in_plane[i] * hoop[j] + hoop[i] * in_plane[j]) +
               (law.lambda + 2. * law.mu) * hoop[i] * hoop[j]);
    }
  }

  template <int dim>
  void ClassBuilder<dim>::set_slot_radii(BodyShape<dim> &shape) const
  {
    const bool at_nodes =
        input_.discretization.interface_quadrature == "gauss lobatto";
    const std::size_t n = face_rule_.size();
    std::vector<double> radii(n); // of a face, or of a part of it
    for (std::size_t s = 0; s < shape.slot_positions.size(); s += n) {
      // on the axis round-off is on both sides of 0
      for (std::size_t q = 0; q < n; ++q)
        radii[q] = std::max(0., radius_at(shape, shape.slot_positions[s + q]));
      for (std::size_t q = 0; q < n; ++q)
        shape.slot_radii.push_back(radius_of_point(radii, q, at_nodes));
    }
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template void weigh_rings(const DiscretizationInput &, std::size_t,          \
                            InterfacePoints<dim> &);                           \
  template Quadrature<dim> ring_quadrature(const ReferenceCell &,              \
                                           unsigned int);                      \
  template void ClassBuilder<dim>::set_axis(BodyShape<dim> &) const;           \
  template void ClassBuilder<dim>::add_hoop(                                   \
      const BodyShape<dim> &, const std::vector<LinearElasticity<dim>> &,      \
      Block &) const;                                                          \
  template void ClassBuilder<dim>::set_slot_radii(BodyShape<dim> &) const
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
