#include "point_traces.h"

#include "core/neighbor_messages.h"
#include "discretization/point_places.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    using Tractions = std::vector<const Block BodyClass::*>;

    template <int dim>
    PointTrace make_trace(const BodyClass &body, const unsigned int slot,
                          const double sign, const double *Q,
                          const long long first, const Tractions &tractions)
    {
      PointTrace trace;
      trace.first = first;
      trace.n_dofs = body.n_dofs;
      const auto rotate = [&](const Block &block, const double factor,
                              std::vector<double> &rows) {
        rows.assign(std::size_t(dim) * body.n_dofs, 0.);
        for (unsigned int k = 0; k < dim && block.cols > 0; ++k)
          for (unsigned int j = 0; j < body.n_dofs; ++j) {
            double value = 0.;
            for (unsigned int c = 0; c < dim; ++c)
              value += Q[k * dim + c] * block(slot * dim + c, j);
            rows[k * body.n_dofs + j] = factor * value;
          }
      };
      rotate(body.trace, sign, trace.jump);
      // n leaves body 1, enters body 2
      if (!tractions.empty())
        rotate(body.*tractions[0], -sign, trace.traction);
      if (tractions.size() > 1)
        rotate(body.*tractions[1], -sign, trace.viscous_traction);
      return trace;
    }

    /** For a message: @p size numbers for each kind of rows. */
    void pack(const PointTrace &trace, const std::size_t size, double *out)
    {
      *out++ = double(trace.first); // below 2^53
      *out++ = trace.n_dofs;
      for (const auto *rows :
           {&trace.jump, &trace.traction, &trace.viscous_traction}) {
        std::copy(rows->begin(), rows->end(), out);
        out += size;
      }
    }

    PointTrace unpack(const unsigned int dim, const std::size_t size,
                      const std::size_t n_tractions, const double *in)
    {
      PointTrace trace;
      trace.first = static_cast<long long>(in[0]);
      if (trace.first < 0)
        return trace;
      trace.n_dofs = unsigned(in[1]);
      const std::size_t n = std::size_t(dim) * trace.n_dofs;
      in += 2;
      trace.jump.assign(in, in + n);
      if (n_tractions > 0)
        trace.traction.assign(in + size, in + size + n);
      if (n_tractions > 1)
        trace.viscous_traction.assign(in + 2 * size, in + 2 * size + n);
      return trace;
    }

    Tractions tractions_of(const Communicator &communicator,
                           const Bodies &bodies)
    {
      Tractions result{&BodyClass::traction};
      if (communicator.any(std::any_of(
              bodies.classes.begin(), bodies.classes.end(),
              [](const BodyClass &body) { return body.viscous_bound > 0.; })))
        result.push_back(&BodyClass::viscous_traction);
      return result;
    }
  } // namespace

  template <int dim>
  PointTraces::PointTraces(const DelassusOperator<dim> &delassus,
                           const long long first_dof,
                           const std::vector<char> &wanted,
                           const bool with_traction)
  {
    const auto &points = delassus.points();
    const auto &bodies = delassus.bodies();
    const Tractions tractions =
        with_traction ? tractions_of(delassus.communicator(), bodies)
                      : Tractions();
    place_.assign(points.n_points, -1);
    int n = 0;
    for (std::size_t i = 0; i < points.n_points; ++i)
      if (wanted[i])
        place_[i] = n++;
    for (auto &side : sides_)
      side.resize(std::size_t(n));
    for_all_places(
        bodies, points.n_points,
        [&](const std::size_t b, const unsigned int slot,
            const std::size_t point, const unsigned int s) {
          if (wanted[point])
            sides_[s][place_[point]] = make_trace<dim>(
                bodies.classes[bodies.class_of[b]], slot, s == 1 ? 1. : -1.,
                points.frame.data() + point * dim * dim,
                first_dof + static_cast<long long>(bodies.first_dof[b]),
                tractions);
        });

    double largest = 0.;
    for (const auto &body : bodies.classes)
      largest = std::max(largest, double(body.n_dofs));
    const std::size_t size = dim *
                             std::size_t(delassus.communicator().max(largest)),
                      stride = 2 + 3 * size;
    NeighborMessages<double> exchange;
    for (const auto &neighbor : points.neighbors) {
      auto &message = exchange.messages.emplace_back();
      message.rank = neighbor.rank;
      message.in.resize(neighbor.points.size() * stride);
      message.out.assign(message.in.size(), -1.);
      for (std::size_t j = 0; j < neighbor.points.size(); ++j)
        pack((*this)(neighbor.side[j], neighbor.points[j]), size,
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
              unpack(dim, size, tractions.size(),
                     &exchange.messages[k].in[j * stride]);
      }
    }
  }

  template PointTraces::PointTraces(const DelassusOperator<2> &, long long,
                                    const std::vector<char> &, bool);
  template PointTraces::PointTraces(const DelassusOperator<3> &, long long,
                                    const std::vector<char> &, bool);
} // namespace nsfd
