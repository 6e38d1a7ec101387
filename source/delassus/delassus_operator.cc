#include "delassus_operator.h"

#include "block_inverse.h"
#include "body_loops.h"

#include "core/cost.h"
#include "discretization/point_places.h"
#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /**
     * Diagonal blocks of W in the local frames: of each point by itself, or of
     * the @p whole of its face.
     */
    template <int dim>
    std::vector<double> diagonal_blocks(const DelassusOperator<dim> &delassus,
                                        const bool whole)
    {
      const auto &points = delassus.points();
      const auto &bodies = delassus.bodies();
      const auto &blocks = delassus.class_blocks();
      const auto &communicator = delassus.communicator();
      // Cartesian blocks of both sides, row by row of a point of the face, so
      // that shared faces can be completed by the point exchange.
      std::size_t width = 1;
      for (const auto &face : points.faces)
        width = std::max<std::size_t>(width, whole ? face.count : 1);
      width = std::size_t(communicator.max(
          static_cast<double>(width))); // same stride everywhere
      const std::size_t row = width * dim, stride = dim * row;
      const auto place = point_places(bodies, points.n_points);
      const auto first_of = [&](const unsigned int p) { return whole ? 0 : p; };
      const auto count_of = [&](const auto &face) {
        return whole ? face.count : 1u;
      };
      const auto fill = [&](const auto &face, const unsigned int side,
                            double *out) {
        for (unsigned int p = 0; p < face.count; ++p) {
          const PointPlace mine = place[side][face.first + p];
          if (mine.body < 0)
            continue;
          const Block &W = blocks[bodies.class_of[mine.body]].delassus;
          for (unsigned int q = 0; q < count_of(face); ++q) {
            const PointPlace other = place[side][face.first + first_of(p) + q];
            for (unsigned int c = 0; c < dim; ++c)
              for (unsigned int d = 0; d < dim; ++d)
                out[p * stride + c * row + q * dim + d] =
                    W(mine.slot * dim + c, other.slot * dim + d);
          }
        }
      };
      // on one rank a face at a time: all of them take twice what is kept
      const bool alone = communicator.size() == 1;
      std::size_t longest = 0, size = 0;
      for (const auto &face : points.faces) {
        longest = std::max<std::size_t>(longest, face.count);
        size += std::size_t(face.count) * dim * count_of(face) * dim;
      }
      std::array<std::vector<double>, 2> sides;
      for (auto &side : sides)
        side.assign((alone ? longest : points.n_points) * stride, 0.);
      if (!alone) {
        for (const auto &face : points.faces)
          for (unsigned int side = 0; side < 2; ++side)
            fill(face, side, sides[side].data() + face.first * stride);
        delassus.exchange({{sides[0].data(), sides[1].data()}},
                          unsigned(stride));
      }

      std::vector<double> result(whole ? size : points.n_points * dim * dim,
                                 0.);
      double *next = result.data();
      for (const auto &face : points.faces) {
        const unsigned int n = count_of(face) * dim;
        // points of a step need not be in the order of the faces
        double *const block =
            whole ? next : result.data() + std::size_t(face.first) * dim * dim;
        for (unsigned int side = 0; side < 2 && alone; ++side) {
          std::fill(sides[side].begin(), sides[side].end(), 0.);
          fill(face, side, sides[side].data());
        }
        const std::size_t first = alone ? 0 : face.first;
        for (unsigned int p = 0; p < face.count; ++p)
          for (unsigned int q = 0; q < count_of(face); ++q) {
            const double *Qp = points.axes(face.first + p);
            const double *Qq = points.axes(face.first + first_of(p) + q);
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int j = 0; j < dim; ++j) {
                double value = 0.;
                for (unsigned int c = 0; c < dim; ++c)
                  for (unsigned int d = 0; d < dim; ++d) {
                    const std::size_t k =
                        (first + p) * stride + c * row + q * dim + d;
                    value += Qp[i * dim + c] * (sides[1][k] + sides[0][k]) *
                             Qq[j * dim + d];
                  }
                block[(p * dim + i) * n + q * dim + j] = value;
              }
          }
        next += std::size_t(face.count) * dim * n;
      }
      return result;
    }
  } // namespace

  template <int dim>
  DelassusOperator<dim>::DelassusOperator(const Communicator &communicator,
                                          const Bodies &bodies,
                                          const InterfacePoints<dim> &points)
      : FaceTraces<dim>(communicator, bodies, points)
  {
  }

  template <int dim>
  void DelassusOperator<dim>::renew(const double time_step, const double theta)
  {
    this->reset_traces();
    time_step_ = theta_ = 0.;
    reinit(time_step, theta);
  }

  template <int dim>
  void DelassusOperator<dim>::reinit(const double time_step, const double theta)
  {
    if (time_step == time_step_ && theta == theta_)
      return;
    const Charge charge(Cost::blocks);
    time_step_ = time_step;
    theta_ = theta;
    blocks_.resize(bodies_.classes.size());
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      const BodyClass &body = bodies_.classes[k];
      const BlockInverse inverse(body, shares(time_step, theta));
      ++counters_.factorisations;
      blocks_[k].delassus = inverse.form(this->trace_transposed(k));
      if (!bodies_are_apart())
        continue; // none of them moves alone
      Block identity(body.n_dofs, body.n_dofs);
      for (unsigned int i = 0; i < body.n_dofs; ++i)
        identity(i, i) = 1.;
      blocks_[k].inverse = inverse.form(identity);
      blocks_[k].velocity_change =
          product(blocks_[k].inverse, this->trace_transposed(k));
    }
    if (!keeps_face_blocks_) {
      point_blocks_ = diagonal_blocks(*this, false);
      return;
    }
    face_blocks_ = diagonal_blocks(*this, true);
    face_offset_.assign(1, 0);
    point_blocks_.assign(points_.n_points * dim * dim, 0.);
    for (const auto &face : points_.faces) {
      const std::size_t n = std::size_t(face.count) * dim;
      const double *W = face_blocks_.data() + face_offset_.back();
      for (std::size_t p = 0; p < face.count; ++p)
        for (std::size_t r = 0; r < dim; ++r)
          std::copy_n(W + (p * dim + r) * n + p * dim, dim,
                      &point_blocks_[((face.first + p) * dim + r) * dim]);
      face_offset_.push_back(face_offset_.back() + n * n);
    }
  }

  template <int dim>
  void DelassusOperator<dim>::serialize(Archive &archive)
  {
    double h = time_step_, theta = theta_;
    archive.numbers("step", h, theta);
    if (archive.reads())
      reinit(h, theta);
  }

  template <int dim>
  void DelassusOperator<dim>::apply_delassus(const double *impulse,
                                             double *velocity) const
  {
    const Charge charge(Cost::delassus);
    ++counters_.delassus;
    this->to_cartesian(impulse);
    values_of_both_sides(
        *this, this->order(),
        [this](const std::size_t k) -> const Block & {
          return blocks_[k].delassus;
        },
        slot_gather<dim>(bodies_, cartesian_), side_1_, side_2_);
    this->add_sides(velocity);
  }

  template <int dim>
  void DelassusOperator<dim>::delassus_sides(
      const double *impulse, std::array<std::vector<double>, 2> &side) const
  {
    std::vector<double> sum(points_.n_points * dim);
    apply_delassus(impulse, sum.data());
    side = {{side_1_, side_2_}};
  }

  template <int dim>
  void DelassusOperator<dim>::add_velocity_change(const double *impulse,
                                                  double *velocity) const
  {
    this->to_cartesian(impulse);
    for_all_bodies(
        bodies_,
        [this](const std::size_t k) -> const Block & {
          return blocks_[k].velocity_change;
        },
        slot_gather<dim>(bodies_, cartesian_),
        dof_scatter<true>(bodies_, velocity));
  }

  template <int dim>
  void DelassusOperator<dim>::apply(const Operator op, const double *x,
                                    double *y) const
  {
    if (op == Operator::stiffness || op == Operator::damping)
      std::fill(y, y + bodies_.n_dofs(), 0.);
    for_all_bodies(
        bodies_,
        [this, op](const std::size_t k) -> const Block & {
          return op == Operator::mass        ? bodies_.classes[k].mass
                 : op == Operator::stiffness ? bodies_.classes[k].stiffness
                 : op == Operator::damping   ? bodies_.classes[k].damping
                                             : blocks_[k].inverse;
        },
        dof_gather(bodies_, x), dof_scatter<false>(bodies_, y));
  }

  template class DelassusOperator<2>;
  template class DelassusOperator<3>;
} // namespace nsfd
