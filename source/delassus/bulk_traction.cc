#include "bulk_traction.h"

#include "body_loops.h"

#include "discretization/initial_stress.h"

#include <algorithm>
#include <array>

namespace nsfd
{
  template <int dim>
  BulkTraction<dim>::BulkTraction(const DelassusOperator<dim> &delassus,
                                  const InitialStress<dim> *const initial)
      : delassus_(delassus), initial_(initial),
        share_(delassus.points().n_points)
  {
    set_shares();
    side_1_.resize((share_.size() + 1) * dim);
    side_2_.resize((share_.size() + 1) * dim);
  }

  template <int dim>
  void BulkTraction<dim>::mark(const std::vector<char> &faces)
  {
    const auto &points = delassus_.points();
    std::vector<char> is_at(delassus_.bodies().size(), 0);
    marked_points_.clear();
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const auto &face = points.faces[f];
      for (const int body : face.bodies)
        if (faces[f] && body >= 0)
          is_at[std::size_t(body)] = 1;
      for (unsigned int i = face.first; faces[f] && i < face.first + face.count;
           ++i)
        marked_points_.push_back(i);
    }
    marked_ = delassus_.order();
    for (auto &members : marked_.classes) {
      std::size_t n_shared = 0, n = 0;
      for (std::size_t k = 0; k < members.bodies.size(); ++k)
        if (is_at[members.bodies[k]]) {
          n_shared += k < members.n_shared;
          members.bodies[n++] = members.bodies[k];
        }
      members.bodies.resize(n);
      members.n_shared = n_shared;
    }
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
                                   const Where where, double *traction) const
  {
    mean(&BodyClass::traction, displacement, where, traction);
    if (!initial_)
      return;
    const auto add = [&](const std::size_t point) {
      for (unsigned int c = 0; c < dim; ++c)
        traction[point * dim + c] += initial_->local_traction(point)[c];
    };
    if (where == Where::marked)
      for (const unsigned int i : marked_points_)
        add(i);
    else
      for (std::size_t i = 0; i < share_.size(); ++i)
        add(i);
  }

  template <int dim>
  void BulkTraction<dim>::evaluate_viscous(const double *velocity,
                                           const Where where,
                                           double *traction) const
  {
    mean(&BodyClass::viscous_traction, velocity, where, traction);
  }

  /** Blocks times the motion of the bodies, weighted, in the local frames. */
  template <int dim>
  void BulkTraction<dim>::mean(const Block BodyClass::*block,
                               const double *motion, const Where where,
                               double *traction) const
  {
    const auto &points = delassus_.points();
    const auto &bodies = delassus_.bodies();
    const auto add = [&](const std::size_t i) {
      const double *Q = points.axes(i);
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
    };
    const bool all = where == Where::everywhere;
    if (all) { // points without a body have nothing
      std::fill(side_1_.begin(), side_1_.end(), 0.);
      std::fill(side_2_.begin(), side_2_.end(), 0.);
    } else
      for (const unsigned int i : marked_points_)
        for (unsigned int c = 0; c < dim; ++c)
          side_1_[i * dim + c] = side_2_[i * dim + c] = 0.;
    values_of_both_sides(
        delassus_, all ? delassus_.order() : marked_,
        [&](const std::size_t k) -> const Block & {
          return bodies.classes[k].*block;
        },
        dof_gather(bodies, motion), side_1_, side_2_);
    if (all)
      for (std::size_t i = 0; i < points.n_points; ++i)
        add(i);
    else
      for (const unsigned int i : marked_points_)
        add(i);
  }

  template class BulkTraction<2>;
  template class BulkTraction<3>;
} // namespace nsfd
