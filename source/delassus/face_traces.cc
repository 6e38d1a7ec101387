#include "face_traces.h"

#include "body_loops.h"

#include "core/pages_of_zeros.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  FaceTraces<dim>::FaceTraces(const Communicator &communicator,
                              const Bodies &bodies,
                              const InterfacePoints<dim> &points)
      : communicator_(communicator), bodies_(bodies), points_(points)
  {
    reset_traces();
  }

  template <int dim>
  void FaceTraces<dim>::reset_traces()
  {
    order_ = shared_first(bodies_, points_);
    for (auto *vector : {&cartesian_, &side_1_, &side_2_}) {
      vector->assign((points_.n_points + 1) * dim, 0.);
      release_pages_of_zeros(*vector); // some operators never fill them
    }
    trace_transposed_.clear();
    for (const BodyClass &body : bodies_.classes)
      trace_transposed_.push_back(body.trace.transposed());
  }

  template <int dim>
  void FaceTraces<dim>::to_cartesian(const double *local) const
  {
    for (std::size_t i = 0; i < points_.n_points; ++i) {
      const double *Q = points_.axes(i);
      for (unsigned int c = 0; c < dim; ++c) {
        double value = 0.;
        for (unsigned int k = 0; k < dim; ++k)
          value += Q[k * dim + c] * local[i * dim + k];
        cartesian_[i * dim + c] = value;
      }
    }
  }

  template <int dim>
  void FaceTraces<dim>::add_sides(double *local) const
  {
    for (std::size_t i = 0; i < points_.n_points; ++i) {
      const double *Q = points_.axes(i);
      double jump[dim];
      for (unsigned int c = 0; c < dim; ++c)
        jump[c] = side_2_[i * dim + c] + side_1_[i * dim + c];
      for (unsigned int k = 0; k < dim; ++k) {
        double value = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          value += Q[k * dim + c] * jump[c];
        local[i * dim + k] = value;
      }
    }
  }

  template <int dim>
  void FaceTraces<dim>::relative_velocity(const double *velocity,
                                          double *result) const
  {
    values_of_both_sides(
        *this, this->order(),
        [this](const std::size_t k) -> const Block & {
          return bodies_.classes[k].trace;
        },
        dof_gather(bodies_, velocity), side_1_, side_2_);
    add_sides(result);
  }

  template <int dim>
  void FaceTraces<dim>::generalised_impulse(const double *impulse,
                                            double *result) const
  {
    to_cartesian(impulse);
    for_all_bodies(
        bodies_,
        [this](const std::size_t k) -> const Block & {
          return trace_transposed_[k];
        },
        slot_gather<dim>(bodies_, cartesian_),
        dof_scatter<false>(bodies_, result));
  }

  template <int dim>
  void FaceTraces<dim>::start_exchange(const std::array<double *, 2> side,
                                       const unsigned int stride) const
  {
    auto &messages = messages_.messages;
    messages.resize(points_.neighbors.size());
    for (std::size_t k = 0; k < messages.size(); ++k) {
      const auto &neighbor = points_.neighbors[k];
      messages[k].rank = neighbor.rank;
      messages[k].in.resize(neighbor.points.size() * stride);
      messages[k].out.resize(neighbor.points.size() * stride);
      for (std::size_t j = 0; j < neighbor.points.size(); ++j)
        std::copy_n(side[neighbor.side[j]] +
                        std::size_t(neighbor.points[j]) * stride,
                    stride, messages[k].out.data() + j * stride);
    }
    messages_.start(communicator_.mpi(), 7);
  }

  template <int dim>
  void FaceTraces<dim>::finish_exchange(const std::array<double *, 2> side,
                                        const unsigned int stride) const
  {
    messages_.finish();
    for (std::size_t k = 0; k < points_.neighbors.size(); ++k) {
      const auto &neighbor = points_.neighbors[k];
      for (std::size_t j = 0; j < neighbor.points.size(); ++j)
        std::copy_n(messages_.messages[k].in.data() + j * stride, stride,
                    side[1 - neighbor.side[j]] +
                        std::size_t(neighbor.points[j]) * stride);
    }
  }

  template class FaceTraces<2>;
  template class FaceTraces<3>;
} // namespace nsfd
