#include "bulk_traction.h"

#include "body_loops.h"

#include <algorithm>
#include <array>

namespace nsfd
{
  template <int dim>
  BulkTraction<dim>::BulkTraction(const DelassusOperator<dim> &delassus)
      : delassus_(delassus), bonds_(delassus.points().n_points)
  {
    set_bonds();
    side_1_.resize((bonds_.size() + 1) * dim);
    side_2_.resize((bonds_.size() + 1) * dim);
  }

  template <int dim>
  void BulkTraction<dim>::set_bonds()
  {
    const auto &points = delassus_.points();
    const auto &bodies = delassus_.bodies();
    std::array<std::vector<double>, 2> bounds; // elastic and viscous
    for (auto &side : bounds)
      side.assign(2 * (points.n_points + 1), -1.); // no body
    for (const auto &face : points.faces)
      for (unsigned int s = 0; s < 2; ++s)
        for (unsigned int p = face.first;
             face.bodies[s] >= 0 && p < face.first + face.count; ++p) {
          const auto &body = bodies.classes[bodies.class_of[face.bodies[s]]];
          bounds[s][2 * std::size_t(p)] = body.traction_bound;
          bounds[s][2 * std::size_t(p) + 1] = body.viscous_bound;
        }
    delassus_.exchange({{bounds[0].data(), bounds[1].data()}}, 2);
    for (std::size_t i = 0; i < bonds_.size(); ++i) {
      const double a = bounds[0][2 * i], b = bounds[1][2 * i];
      if (a < 0. || b < 0.)
        continue; // at the boundary
      Bond &bond = bonds_[i];
      if (a == 0. || b == 0.) {
        bond.weight_1 = a > 0. ? 1. : 0.;
        bond.weight_2 = b > 0. ? 1. : 0.;
        bond.penalty = penalty_factor * (a + b);
      } else {
        bond.weight_1 = b / (a + b);
        bond.weight_2 = a / (a + b);
        bond.penalty = penalty_factor * a * b / (a + b);
      }
      bond.viscous_penalty =
          penalty_factor *
          (bond.weight_1 * bond.weight_1 * bounds[0][2 * i + 1] +
           bond.weight_2 * bond.weight_2 * bounds[1][2 * i + 1]);
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
