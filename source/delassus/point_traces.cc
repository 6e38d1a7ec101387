#include "point_traces.h"

#include "core/neighbor_messages.h"
#include "discretization/point_places.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    template <int dim>
    PointTrace make_trace(const BodyClass &body, const unsigned int slot,
                          const double sign, const double *Q,
                          const long long first)
    {
      PointTrace trace;
      trace.first = first;
      trace.n_dofs = body.n_dofs;
      trace.jump.assign(std::size_t(dim) * body.n_dofs, 0.);
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int j = 0; j < body.n_dofs; ++j) {
          double value = 0.;
          for (unsigned int c = 0; c < dim; ++c)
            value += Q[k * dim + c] * body.trace(slot * dim + c, j);
          trace.jump[k * body.n_dofs + j] = sign * value;
        }
      return trace;
    }

    void pack(const PointTrace &trace, double *out)
    {
      *out++ = double(trace.first); // below 2^53
      *out++ = trace.n_dofs;
      std::copy(trace.jump.begin(), trace.jump.end(), out);
    }

    PointTrace unpack(const unsigned int dim, const double *in)
    {
      PointTrace trace;
      trace.first = static_cast<long long>(in[0]);
      if (trace.first < 0)
        return trace;
      trace.n_dofs = unsigned(in[1]);
      trace.jump.assign(in + 2, in + 2 + std::size_t(dim) * trace.n_dofs);
      return trace;
    }
  } // namespace

  template <int dim>
  PointTraces::PointTraces(const DelassusOperator<dim> &delassus,
                           const long long first_dof,
                           const std::vector<char> &wanted)
  {
    const auto &points = delassus.points();
    const auto &bodies = delassus.bodies();
    place_.assign(points.n_points, -1);
    int n = 0;
    for (std::size_t i = 0; i < points.n_points; ++i)
      if (wanted[i])
        place_[i] = n++;
    for (auto &side : sides_)
      side.resize(std::size_t(n));
    for_all_places(bodies, points.n_points,
                   [&](const std::size_t b, const unsigned int slot,
                       const std::size_t point, const unsigned int s) {
                     if (wanted[point])
                       sides_[s][place_[point]] = make_trace<dim>(
                           bodies.classes[bodies.class_of[b]], slot,
                           s == 1 ? 1. : -1., points.axes(point),
                           first_dof +
                               static_cast<long long>(bodies.first_dof[b]));
                   });

    double largest = 0.;
    for (const auto &body : bodies.classes)
      largest = std::max(largest, double(body.n_dofs));
    const std::size_t stride =
        2 + dim * std::size_t(delassus.communicator().max(largest));
    NeighborMessages<double> exchange;
    for (const auto &neighbor : points.neighbors) {
      auto &message = exchange.messages.emplace_back();
      message.rank = neighbor.rank;
      message.in.resize(neighbor.points.size() * stride);
      message.out.assign(message.in.size(), -1.);
      for (std::size_t j = 0; j < neighbor.points.size(); ++j)
        pack((*this)(neighbor.side[j], neighbor.points[j]),
             &message.out[j * stride]);
    }
    exchange.start(delassus.communicator().mpi(), 23);
    exchange.finish();
    for (std::size_t k = 0; k < points.neighbors.size(); ++k) {
      const auto &neighbor = points.neighbors[k];
      for (std::size_t j = 0; j < neighbor.points.size(); ++j) {
        const int place = place_[neighbor.points[j]];
        if (place >= 0)
          sides_[1 - neighbor.side[j]][place] =
              unpack(dim, &exchange.messages[k].in[j * stride]);
      }
    }
  }

  template PointTraces::PointTraces(const DelassusOperator<2> &, long long,
                                    const std::vector<char> &);
  template PointTraces::PointTraces(const DelassusOperator<3> &, long long,
                                    const std::vector<char> &);
} // namespace nsfd
