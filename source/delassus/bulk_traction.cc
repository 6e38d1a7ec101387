#include "bulk_traction.h"

#include "body_loops.h"

#include <algorithm>
#include <array>

namespace nsfd
{
  template <int dim>
  BulkTraction<dim>::BulkTraction(const DelassusOperator<dim> &delassus)
      : delassus_(delassus), share_(delassus.points().n_points)
  {
    set_shares();
    side_1_.resize((share_.size() + 1) * dim);
    side_2_.resize((share_.size() + 1) * dim);
  }

  template <int dim>
  void BulkTraction<dim>::set_shares()
  {
    const auto &points = delassus_.points();
    const auto &bodies = delassus_.bodies();
    std::array<std::vector<double>, 2> bounds;
    for (auto &side : bounds)
      side.assign(points.n_points + 1, -1.); // no body
    for (const auto &face : points.faces)
      for (unsigned int s = 0; s < 2; ++s)
        for (unsigned int p = face.first;
             face.bodies[s] >= 0 && p < face.first + face.count; ++p)
          bounds[s][p] =
              bodies.classes[bodies.class_of[face.bodies[s]]].traction_bound;
    delassus_.exchange({{bounds[0].data(), bounds[1].data()}}, 1);
    for (std::size_t i = 0; i < share_.size(); ++i) {
      const double a = bounds[0][i], b = bounds[1][i];
      if (a < 0. || b < 0.)
        share_[i] = {}; // at the boundary
      else if (a == 0. || b == 0.)
        share_[i] = {a > 0. ? 1. : 0., b > 0. ? 1. : 0.};
      else
        share_[i] = {b / (a + b), a / (a + b)};
    }
  }

  template <int dim>
  void BulkTraction<dim>::evaluate(const double *displacement,
                                   double *traction) const
  {
    mean(&BodyClass::traction, displacement, traction);
  }

  template <int dim>
  void BulkTraction<dim>::evaluate_viscous(const double *velocity,
                                           double *traction) const
  {
    mean(&BodyClass::viscous_traction, velocity, traction);
  }

  /** Blocks times the motion of the bodies, weighted, in the local frames. */
  template <int dim>
  void BulkTraction<dim>::mean(const Block BodyClass::*block,
                               const double *motion, double *traction) const
  {
    const auto &points = delassus_.points();
    const auto &bodies = delassus_.bodies();
    std::fill(side_1_.begin(), side_1_.end(), 0.);
    std::fill(side_2_.begin(), side_2_.end(), 0.);
    values_of_both_sides(
        delassus_,
        [&](const std::size_t k) -> const Block & {
          return bodies.classes[k].*block;
        },
        dof_gather(bodies, motion), side_1_, side_2_);
    for (std::size_t i = 0; i < points.n_points; ++i) {
      const double *Q = points.frame.data() + i * dim * dim;
      double t[dim];
      // on the outward normals: n of body 1, -n of body 2, whose values are
      // scattered with the sign of the jump
      for (unsigned int c = 0; c < dim; ++c)
        t[c] = -(share_[i][0] * side_1_[i * dim + c] +
                 share_[i][1] * side_2_[i * dim + c]);
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
