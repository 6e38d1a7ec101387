#include "point_traces.h"

#include "discretization/point_places.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /** One point of one body, into @p out: unknowns, jump rows, tractions. */
    template <int dim>
    void write_trace(const BodyClass &body, const unsigned int slot,
                     const double sign, const double *Q, const double first,
                     const unsigned int width,
                     const std::vector<const Block BodyClass::*> &tractions,
                     double *out)
    {
      out[0] = first;
      out[1] = body.n_dofs;
      const auto rotate = [&](const Block &block, const double factor,
                              double *rows) {
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int j = 0; j < body.n_dofs; ++j) {
            double value = 0.;
            for (unsigned int c = 0; c < dim; ++c)
              value += Q[k * dim + c] * block(slot * dim + c, j);
            rows[k * width + j] = factor * value;
          }
      };
      rotate(body.trace, sign, out + 2);
      double *rows = out + 2;
      for (const auto traction : tractions) {
        rows += std::size_t(dim) * width;
        if ((body.*traction).cols > 0)
          rotate(body.*traction, -sign, rows); // n leaves body 1, enters body 2
        else
          std::fill(rows, rows + std::size_t(dim) * width, 0.);
      }
    }

    template <int dim>
    PointTrace read_trace(const double *in, const unsigned int width,
                          const std::size_t n_tractions)
    {
      PointTrace trace;
      if (in[0] < 0.)
        return trace;
      trace.first = static_cast<long long>(in[0]);
      trace.n_dofs = unsigned(in[1]);
      const auto take = [&](const double *rows, std::vector<double> &out) {
        out.resize(std::size_t(dim) * trace.n_dofs);
        for (unsigned int k = 0; k < dim; ++k)
          std::copy_n(rows + std::size_t(k) * width, trace.n_dofs,
                      out.data() + std::size_t(k) * trace.n_dofs);
      };
      take(in + 2, trace.jump);
      if (n_tractions > 0)
        take(in + 2 + std::size_t(dim) * width, trace.traction);
      if (n_tractions > 1)
        take(in + 2 + 2 * std::size_t(dim) * width, trace.viscous_traction);
      return trace;
    }
  } // namespace

  template <int dim>
  std::array<std::vector<PointTrace>, 2>
  point_traces(const DelassusOperator<dim> &delassus, const long long first_dof,
               const bool with_traction)
  {
    const auto &points = delassus.points();
    const auto &bodies = delassus.bodies();
    double largest = 0.;
    for (const auto &body : bodies.classes)
      largest = std::max(largest, double(body.n_dofs));
    const unsigned int width =
        unsigned(delassus.communicator().max(largest)); // on every rank
    std::vector<const Block BodyClass::*> tractions;
    if (with_traction)
      tractions.push_back(&BodyClass::traction);
    if (with_traction &&
        delassus.communicator().any(std::any_of(
            bodies.classes.begin(), bodies.classes.end(),
            [](const BodyClass &body) { return body.viscous_bound > 0.; })))
      tractions.push_back(&BodyClass::viscous_traction);
    const unsigned int stride =
        2 + (1 + unsigned(tractions.size())) * dim * width;
    std::array<std::vector<double>, 2> side;
    for (auto &s : side)
      s.assign((points.n_points + 1) * stride, -1.);
    for_all_places(bodies, points.n_points,
                   [&](const std::size_t b, const unsigned int slot,
                       const std::size_t point, const unsigned int s) {
                     write_trace<dim>(
                         bodies.classes[bodies.class_of[b]], slot,
                         s == 1 ? 1. : -1.,
                         points.frame.data() + point * dim * dim,
                         double(first_dof) + double(bodies.first_dof[b]), width,
                         tractions, side[s].data() + point * stride);
                   });
    delassus.exchange({{side[0].data(), side[1].data()}}, stride);

    std::array<std::vector<PointTrace>, 2> traces;
    for (unsigned int s = 0; s < 2; ++s)
      for (std::size_t i = 0; i < points.n_points; ++i)
        traces[s].push_back(read_trace<dim>(side[s].data() + i * stride, width,
                                            tractions.size()));
    return traces;
  }

  template std::array<std::vector<PointTrace>, 2>
  point_traces<2>(const DelassusOperator<2> &, long long, bool);
  template std::array<std::vector<PointTrace>, 2>
  point_traces<3>(const DelassusOperator<3> &, long long, bool);
} // namespace nsfd
