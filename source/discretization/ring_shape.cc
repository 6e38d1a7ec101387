#include "axis.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe.h>

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
  std::vector<double>
  ClassBuilder<dim>::hoop_at_slots(const BodyShape<dim> &shape) const
  {
    std::vector<double> hoop;
    if (!is_axisymmetric(shape))
      return hoop;
    for (std::size_t s = 0; s < shape.slot_places.size(); ++s) {
      const double r = radius_at(shape, shape.slot_positions[s]);
      // on the axis no point is and no node moves
      const bool is_off = r > axis_tolerance * shape.height;
      for (unsigned int i = 0; i < shape.n_nodes; ++i)
        hoop.push_back(
            is_off ? element_.shape_value(i, shape.slot_places[s]) / r : 0.);
    }
    return hoop;
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template Quadrature<dim> ring_quadrature(const ReferenceCell &,              \
                                           unsigned int);                      \
  template void ClassBuilder<dim>::set_axis(BodyShape<dim> &) const;           \
  template void ClassBuilder<dim>::add_hoop(                                   \
      const BodyShape<dim> &, const std::vector<LinearElasticity<dim>> &,      \
      Block &) const;                                                          \
  template std::vector<double> ClassBuilder<dim>::hoop_at_slots(               \
      const BodyShape<dim> &) const
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
