#include "nsfd/dynamics/bulk_traction.h"

#include "body_loops.h"

#include <algorithm>
#include <array>

namespace nsfd
{
  template <int dim>
  BulkTraction<dim>::BulkTraction(const Dynamics<dim> &dynamics)
    : dynamics_(dynamics)
    , bonds_(dynamics.points().n_points)
  {
    const auto &points = dynamics.points();
    const auto &bodies = dynamics.bodies();
    std::array<std::vector<double>, 2> bound;
    for (auto &side : bound)
      side.assign(points.n_points + 1, -1.); // no body
    for (const auto &face : points.faces)
      for (unsigned int s = 0; s < 2; ++s)
        if (face.bodies[s] >= 0)
          std::fill_n(
            bound[s].begin() + face.first, face.count,
            bodies.classes[bodies.class_of[face.bodies[s]]].traction_bound);
    dynamics.exchange({{bound[0].data(), bound[1].data()}}, 1);
    for (std::size_t i = 0; i < points.n_points; ++i) {
      const double a = bound[0][i], b = bound[1][i];
      if (a < 0. || b < 0.)
        continue; // at the boundary
      if (a == 0. || b == 0.)
        bonds_[i] = {a > 0. ? 1. : 0., b > 0. ? 1. : 0.,
                     penalty_factor * (a + b)};
      else
        bonds_[i] = {b / (a + b), a / (a + b),
                     penalty_factor * a * b / (a + b)};
    }
    side_1_.resize((points.n_points + 1) * dim);
    side_2_.resize((points.n_points + 1) * dim);
  }

  template <int dim>
  void BulkTraction<dim>::evaluate(const double *displacement,
                                   double *traction) const
  {
    const auto &points = dynamics_.points();
    const auto &bodies = dynamics_.bodies();
    std::fill(side_1_.begin(), side_1_.end(), 0.);
    std::fill(side_2_.begin(), side_2_.end(), 0.);
    values_of_both_sides(
      dynamics_, [&bodies](const std::size_t k) -> const Block & {
        return bodies.classes[k].traction;
      },
      dof_gather(bodies, displacement), side_1_, side_2_);
    for (std::size_t i = 0; i < points.n_points; ++i) {
      const double *Q = points.frame.data() + i * dim * dim;
      double t[dim];
      // on the outward normals: n of body 1, -n of body 2, whose values are
      // scattered with the sign of the jump
      for (unsigned int c = 0; c < dim; ++c)
        t[c] = -(bonds_[i].weight_1 * side_1_[i * dim + c] +
                 bonds_[i].weight_2 * side_2_[i * dim + c]);
      for (unsigned int k = 0; k < dim; ++k) {
        double value = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          value += Q[k * dim + c] * t[c];
        traction[i * dim + k] = value;
      }
    }
  }

  template class BulkTraction<2>;
  template class BulkTraction<3>;
} // namespace nsfd
