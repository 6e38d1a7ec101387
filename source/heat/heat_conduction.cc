#include "heat_conduction.h"

#include "discretization/cells.h"
#include "discretization/loads.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace nsfd
{
  template <int dim>
  HeatConduction<dim>::HeatConduction(const Discretization<dim> &discretization,
                                      const Communicator &communicator)
      : discretization_(discretization), communicator_(communicator),
        cells_(discretization)
  {
    find_sides();
    find_bounds();
    find_heated();
    const double fastest = communicator.max(cells_.fastest());
    // 4 kappa / l^2 is the rate of a bar of length l
    if (fastest > 0.)
      longest_step_ = 0.1 * 4. / fastest;
  }

  template <int dim>
  void HeatConduction<dim>::find_sides()
  {
    const auto &bodies = discretization_.bodies();
    const std::size_t n = discretization_.points().n_points;
    sides_.resize(n);
    const auto put = [&](const std::size_t b, const std::size_t slot,
                         const unsigned int point, const unsigned int side) {
      sides_[point][side] = {int(b), unsigned(slot - bodies.first_slot[b])};
      ends_.emplace_back(point, side);
    };
    for (std::size_t b = 0; b < bodies.size(); ++b)
      for (std::size_t s = bodies.first_slot[b]; s < bodies.first_slot[b + 1];
           ++s)
        if (bodies.slot_point[s] < n)
          put(b, s, bodies.slot_point[s], bodies.slot_sign[s] > 0 ? 1 : 0);
    for (const auto &[slot, point] : bodies.extra_points) {
      const auto next = std::upper_bound(bodies.first_slot.begin(),
                                         bodies.first_slot.end(), slot);
      put(std::size_t(next - bodies.first_slot.begin()) - 1, slot, point, 1);
    }
    for (const auto &neighbor : discretization_.points().neighbors) {
      auto &message = messages_.messages.emplace_back();
      message.rank = neighbor.rank;
      message.out.resize(neighbor.points.size());
      message.in.resize(neighbor.points.size());
    }
  }

  template <int dim>
  void HeatConduction<dim>::find_heated()
  {
    const auto &cells = discretization_.cells();
    const auto &boundaries = discretization_.input().boundaries;
    const typename Loads<dim>::LoadedFace *of_temperature = nullptr;
    for (const auto &face : discretization_.loads().heated_faces()) {
      if (boundaries[face.boundary].temperature) {
        if (of_temperature && of_temperature->body == face.body &&
            of_temperature->face == face.face)
          continue; // the first one holds
        of_temperature = &face;
      }
      const auto of_body = cells.shape(face.body);
      const BodyShape<dim> &shape = *of_body;
      for (unsigned int s = 0; s < shape.slot_faces.size(); ++s)
        if (shape.slot_faces[s] == face.face)
          heated_.push_back({{int(face.body), s},
                             face.boundary,
                             slot_area(shape, s),
                             2. * cells_.of(face.body).flux_bound,
                             cells.place(face.body, shape.slot_positions[s])});
    }
  }

  template <int dim>
  bool HeatConduction<dim>::has_temperature(const Heated &slot) const
  {
    return bool(discretization_.input().boundaries[slot.boundary].temperature);
  }

  /** At the end of the step. */
  template <int dim>
  void HeatConduction<dim>::set_heated(const State &state)
  {
    for (Heated &slot : heated_) {
      const auto &boundary = discretization_.input().boundaries[slot.boundary];
      slot.given =
          (boundary.temperature ? *boundary.temperature : *boundary.heat_flux)
              .at(slot.place, state.clock.at(slot.boundary, state.time));
    }
  }

  /** Of values @p x at corners, on the outward normal. */
  template <int dim>
  auto HeatConduction<dim>::trace_of(const Side &side, const double *x) const
      -> Trace
  {
    const unsigned int n = cells_.n_corners();
    const HeatCell &cell = cells_.of(std::size_t(side.cell));
    const double *const X = x + std::size_t(side.cell) * n;
    Trace trace;
    for (unsigned int v = 0; v < n; ++v) {
      trace.value += cell.values[std::size_t(side.slot) * n + v] * X[v];
      trace.flux += cell.fluxes[std::size_t(side.slot) * n + v] * X[v];
    }
    return trace;
  }

  /** What the other sides of shared points have. */
  template <int dim>
  void HeatConduction<dim>::exchange(std::vector<std::array<Trace, 2>> &traces,
                                     const int tag)
  {
    const auto &neighbors = discretization_.points().neighbors;
    for (std::size_t m = 0; m < neighbors.size(); ++m)
      for (std::size_t k = 0; k < neighbors[m].points.size(); ++k)
        messages_.messages[m].out[k] =
            traces[neighbors[m].points[k]][neighbors[m].side[k]];
    messages_.start(communicator_.mpi(), tag);
    messages_.finish();
    for (std::size_t m = 0; m < neighbors.size(); ++m)
      for (std::size_t k = 0; k < neighbors[m].points.size(); ++k)
        traces[neighbors[m].points[k]][1 - neighbors[m].side[k]] =
            messages_.messages[m].in[k];
  }

  /** Of both sides of the points. */
  template <int dim>
  void HeatConduction<dim>::find_bounds()
  {
    std::vector<std::array<Trace, 2>> traces(sides_.size());
    for (std::size_t i = 0; i < sides_.size(); ++i)
      for (unsigned int s = 0; s < 2; ++s)
        if (const int b = sides_[i][s].cell; b >= 0) {
          const HeatCell &cell = cells_.of(std::size_t(b));
          traces[i][s] = {cell.flux_bound, cell.effusivity};
        }
    exchange(traces, 711);
    const auto &points = discretization_.points();
    bound_.resize(sides_.size());
    share_1_.resize(sides_.size());
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const auto &[one, two] = traces[i];
      const bool inside = !points.faces[points.face_of[i]].boundary;
      const bool both = one.value > 0. && two.value > 0.;
      bound_[i] = inside && both ? std::max(one.value, two.value) : 0.;
      share_1_[i] = !inside ? 0.
                    : both  ? one.flux / (one.flux + two.flux)
                            : 0.5;
    }
  }

  template <int dim>
  void HeatConduction<dim>::warm(const std::vector<double> &points,
                                 std::vector<double> &temperature) const
  {
    const unsigned int n = cells_.n_corners();
    if (points.empty())
      return;
    for (const auto &[i, s] : ends_) {
      if (points[i] == 0.)
        continue;
      const Side &side = sides_[i][s];
      const double energy =
          points[i] * (s == 0 ? share_1_[i] : 1. - share_1_[i]);
      const HeatCell &cell = cells_.of(std::size_t(side.cell));
      double *const T = &temperature[std::size_t(side.cell) * n];
      const double *const N = &cell.values[std::size_t(side.slot) * n];
      for (unsigned int v = 0; v < n; ++v)
        T[v] += energy * N[v] / cell.capacity[v];
    }
  }

  template <int dim>
  std::vector<double>
  HeatConduction<dim>::at_faces(const std::vector<double> &temperature)
  {
    std::vector<std::array<Trace, 2>> traces(sides_.size());
    for (std::size_t i = 0; i < sides_.size(); ++i)
      for (unsigned int s = 0; s < 2; ++s)
        if (sides_[i][s].cell >= 0)
          traces[i][s] = trace_of(sides_[i][s], temperature.data());
    exchange(traces, 713);
    std::vector<double> result(sides_.size());
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] = share_1_[i] * traces[i][0].value +
                  (1. - share_1_[i]) * traces[i][1].value;
    return result;
  }

  /** 1/h of a point, m^2 K / W. */
  template <int dim>
  double HeatConduction<dim>::resistance(const std::size_t i,
                                         const State &state) const
  {
    const PointOrigin origin = discretization_.origins()[i];
    const auto &block = discretization_.input().interfaces[origin.block];
    const PointKind kind = state.kind[i];
    const bool parted =
        kind == PointKind::free || kind == PointKind::separated ||
        (kind == PointKind::cohesive && state.beta[i] <= block.broken_beta());
    if (!parted)
      return 0.;
    const double closed =
        block.heat.conductance ? 1. / *block.heat.conductance : 0.;
    if (state.contact[i] || state.jump[i * dim] <= 0.)
      return closed;
    return block.heat.gap_conductivity > 0.
               ? closed + state.jump[i * dim] / block.heat.gap_conductivity
               : std::numeric_limits<double>::infinity();
  }

  template <int dim>
  void HeatConduction<dim>::set_faces(const State &state)
  {
    const auto &weight = discretization_.points().weight;
    faces_.clear();
    face_of_.assign(bound_.size(), -1);
    for (std::size_t i = 0; i < bound_.size(); ++i) {
      if (bound_[i] == 0.)
        continue;
      const double R = resistance(i, state), g = 1. / bound_[i], w = weight[i];
      if (!std::isfinite(R))
        continue;
      face_of_[i] = int(faces_.size());
      faces_.push_back(
          {unsigned(i), -w * g / (R + g), w / (R + g), -w * g * R / (R + g)});
    }
  }

  /** y = (C + length K) x. */
  template <int dim>
  void HeatConduction<dim>::apply(const double length,
                                  const std::vector<double> &x,
                                  std::vector<double> &y)
  {
    const unsigned int n = cells_.n_corners();
    for (std::size_t b = 0; b * n < x.size(); ++b) {
      const HeatCell &cell = cells_.of(b);
      for (unsigned int i = 0; i < n; ++i) {
        double flow = 0.;
        for (unsigned int j = 0; j < n; ++j)
          flow += cell.conduction[i * n + j] * x[b * n + j];
        y[b * n + i] = cell.capacity[i] * x[b * n + i] + length * flow;
      }
    }
    for (const Face &face : faces_)
      for (unsigned int s = 0; s < 2; ++s) {
        const Side &side = sides_[face.point][s];
        if (side.cell < 0)
          continue;
        Trace trace = trace_of(side, x.data());
        if (s == 1) // its outward normal is the other way
          trace.flux = -trace.flux;
        traces_[face.point][s] = trace;
      }
    exchange(traces_, 712);
    for (const auto &[point, s] : ends_) {
      if (face_of_[point] < 0)
        continue;
      const Face &face = faces_[std::size_t(face_of_[point])];
      const auto &[one, two] = traces_[point];
      const double jump = one.value - two.value,
                   q = 0.5 * (one.flux + two.flux),
                   on_jump = length * (face.mixed * q + face.jump * jump),
                   on_flux = length * (face.mixed * jump + face.flux * q) / 2.;
      const Side &side = sides_[point][s];
      const HeatCell &cell = cells_.of(std::size_t(side.cell));
      double *const Y = &y[std::size_t(side.cell) * n];
      const double sign = s == 0 ? 1. : -1.;
      for (unsigned int v = 0; v < n; ++v)
        Y[v] += sign * (on_jump * cell.values[std::size_t(side.slot) * n + v] +
                        on_flux * cell.fluxes[std::size_t(side.slot) * n + v]);
    }
    for (const Heated &slot : heated_) {
      if (!has_temperature(slot))
        continue;
      const Trace trace = trace_of(slot.side, x.data());
      const HeatCell &cell = cells_.of(std::size_t(slot.side.cell));
      double *const Y = &y[std::size_t(slot.side.cell) * n];
      for (unsigned int v = 0; v < n; ++v) {
        const std::size_t k = std::size_t(slot.side.slot) * n + v;
        Y[v] += length * slot.weight *
                ((slot.bound * trace.value - trace.flux) * cell.values[k] -
                 trace.value * cell.fluxes[k]);
      }
    }
  }

  template <int dim>
  std::vector<double> HeatConduction<dim>::diagonal(const double length) const
  {
    const unsigned int n = cells_.n_corners();
    std::vector<double> result(discretization_.bodies().size() * n);
    for (std::size_t b = 0; b * n < result.size(); ++b) {
      const HeatCell &cell = cells_.of(b);
      for (unsigned int i = 0; i < n; ++i)
        result[b * n + i] =
            cell.capacity[i] + length * cell.conduction[i * n + i];
    }
    for (const auto &[point, s] : ends_) {
      if (face_of_[point] < 0)
        continue;
      const Face &face = faces_[std::size_t(face_of_[point])];
      const Side &side = sides_[point][s];
      const HeatCell &cell = cells_.of(std::size_t(side.cell));
      for (unsigned int v = 0; v < n; ++v) {
        const double N = cell.values[std::size_t(side.slot) * n + v],
                     f = cell.fluxes[std::size_t(side.slot) * n + v];
        result[std::size_t(side.cell) * n + v] +=
            length *
            (face.mixed * f * N + face.jump * N * N + face.flux * f * f / 4.);
      }
    }
    for (const Heated &slot : heated_) {
      if (!has_temperature(slot))
        continue;
      const HeatCell &cell = cells_.of(std::size_t(slot.side.cell));
      for (unsigned int v = 0; v < n; ++v) {
        const std::size_t k = std::size_t(slot.side.slot) * n + v;
        const double N = cell.values[k];
        result[std::size_t(slot.side.cell) * n + v] +=
            length * slot.weight * N * (slot.bound * N - 2. * cell.fluxes[k]);
      }
    }
    return result;
  }

  template <int dim>
  auto HeatConduction<dim>::conduct(const double length, const State &state,
                                    std::vector<double> &temperature) -> Step
  {
    // of the residual, relative: the digits that sums have
    constexpr double tolerance = 1e-13;
    set_faces(state);
    set_heated(state);
    traces_.resize(sides_.size());
    const std::size_t n = temperature.size();
    const auto dot = [&](const std::vector<double> &a,
                         const std::vector<double> &b) {
      return communicator_.dot(a.data(), b.data(), n);
    };
    // (C + length K) change = -length K T
    std::vector<double> r(n), p(n), z(n), product(n), change(n, 0.);
    apply(length, temperature, product);
    const unsigned int m = cells_.n_corners();
    for (std::size_t b = 0; b * m < n; ++b)
      for (unsigned int i = 0; i < m; ++i)
        r[b * m + i] = cells_.of(b).capacity[i] * temperature[b * m + i] -
                       product[b * m + i];
    for (const Heated &slot : heated_) {
      const HeatCell &cell = cells_.of(std::size_t(slot.side.cell));
      for (unsigned int v = 0; v < m; ++v) {
        const std::size_t at = std::size_t(slot.side.slot) * m + v;
        const double N = cell.values[at];
        r[std::size_t(slot.side.cell) * m + v] +=
            length * slot.weight * slot.given *
            (has_temperature(slot) ? slot.bound * N - cell.fluxes[at] : N);
      }
    }
    const std::vector<double> D = diagonal(length);
    const auto precondition = [&] {
      for (std::size_t k = 0; k < n; ++k)
        z[k] = r[k] / D[k];
    };
    precondition();
    p = z;
    double rz = dot(r, z);
    const double enough = tolerance * tolerance * rz;
    const auto n_all = double(communicator_.sum_integer(n));
    const auto most = unsigned(std::min(1e9, 1000. + 10. * n_all));
    unsigned int k = 0;
    for (; rz > enough; ++k) {
      if (k == most || !std::isfinite(rz))
        throw std::runtime_error(
            fmt::format("the temperatures are not found: {} iterations leave "
                        "{:.1e} of the imbalance of a step of {:.4g} s",
                        k, std::sqrt(rz / enough) * tolerance, length));
      apply(length, p, product);
      const double a = rz / dot(p, product);
      for (std::size_t i = 0; i < n; ++i) {
        change[i] += a * p[i];
        r[i] -= a * product[i];
      }
      precondition();
      const double next = dot(r, z), b = next / rz;
      rz = next;
      for (std::size_t i = 0; i < n; ++i)
        p[i] = z[i] + b * p[i];
    }
    for (std::size_t i = 0; i < n; ++i)
      temperature[i] += change[i];
    std::vector<double> given;
    for (const Heated &slot : heated_) {
      double flux = slot.given;
      if (has_temperature(slot)) {
        const Trace trace = trace_of(slot.side, temperature.data());
        flux = trace.flux - slot.bound * (trace.value - slot.given);
      }
      given.push_back(length * slot.weight * flux);
    }
    const bool heats = has_heated_sides(discretization_.input());
    return {k, heats ? communicator_.sum(given) : 0.};
  }

  template class HeatConduction<2>;
  template class HeatConduction<3>;
} // namespace nsfd
