#include "extremes.h"

#include "core/gather.h"
#include "discretization/body_shape.h"
#include "discretization/body_thickness.h"
#include "discretization/cells.h"
#include "sharp_front.h"

#include "discretization/cell_geometry.h"
#include "nsfd/core/archive.h"
#include "nsfd/obstacles/obstacle_shape.h"
#include "nsfd/scene/scene_input.h"
#include "records/engineering.h"

#include <deal.II/base/symmetric_tensor.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /**
     * Where gradients of a cell are largest: linear ones at its vertices,
     * those of simplices anywhere.
     */
    template <int dim>
    std::vector<Point<dim>> places_of(const ReferenceCell &cell)
    {
      std::vector<Point<dim>> vertices;
      for (unsigned int v = 0; v < cell.n_vertices(); ++v)
        vertices.push_back(cell.template vertex<dim>(v));
      return cell.is_simplex() ? std::vector<Point<dim>>{mean(vertices)}
                               : vertices;
    }

    /** Values at the corners of a cell, (corner, component) x unknown. */
    template <int dim>
    std::vector<double> corner_rows(const BodyShape<dim> &shape,
                                    const BodyClass &body)
    {
      const std::size_t n_corners = shape.corners.size(), n = body.n_dofs;
      std::vector<double> rows(n_corners * dim * n, 0.);
      for (std::size_t v = 0; v < n_corners; ++v)
        for (unsigned int node = 0; node < shape.n_nodes; ++node) {
          const double value = shape.corner_values[v * shape.n_nodes + node];
          for (unsigned int c = 0; c < dim; ++c) {
            double *row = rows.data() + (v * dim + c) * n;
            if (!body.rigid)
              row[node * dim + c] += value;
            else
              for (std::size_t k = 0; k < n; ++k)
                row[k] += value * shape.modes(node * dim + c, unsigned(k));
          }
        }
      return rows;
    }

    template <int dim>
    std::vector<double> gradient_rows(const BodyShape<dim> &shape,
                                      const BodyClass &body)
    {
      const auto rows = corner_rows(shape, body);
      const std::size_t n = body.n_dofs;
      const auto places = places_of<dim>(shape.reference);
      std::vector<double> result(places.size() * dim * dim * n, 0.);
      for (std::size_t p = 0; p < places.size(); ++p) {
        const auto inverse =
            invert(jacobian(shape.reference, shape.corners, places[p]));
        for (unsigned int v = 0; v < shape.corners.size(); ++v) {
          const Tensor<1, dim> g =
              linear_gradient<dim>(shape.reference, places[p], v) * inverse;
          for (unsigned int c = 0; c < dim; ++c)
            for (unsigned int d = 0; d < dim; ++d)
              for (std::size_t k = 0; k < n; ++k)
                result[((p * dim + c) * dim + d) * n + k] +=
                    g[d] * rows[(v * dim + c) * n + k];
        }
      }
      return result;
    }

    /** Of the antisymmetric part, rad. */
    double angle(const Tensor<2, 2> &G)
    {
      return std::abs(G[1][0] - G[0][1]) / 2.;
    }
    double angle(const Tensor<2, 3> &G)
    {
      const double x = G[2][1] - G[1][2], y = G[0][2] - G[2][0],
                   z = G[1][0] - G[0][1];
      return std::sqrt(x * x + y * y + z * z) / 2.;
    }

    template <int dim>
    double largest_principal(const Tensor<2, dim> &G)
    {
      const auto values = eigenvalues(symmetrize(G));
      return std::max(std::abs(values[0]), std::abs(values[dim - 1]));
    }

    template <int dim>
    std::array<double, 3> in_space(const Point<dim> &x)
    {
      std::array<double, 3> result{};
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = x[d];
      return result;
    }

    void raise(Peak &peak, const double value, const double time,
               const std::array<double, 3> &place)
    {
      // NaN is the largest of all
      if (!(value <= peak.value) && !std::isnan(peak.value))
        peak = {value, time, place};
    }
  } // namespace

  template <int dim>
  Extremes<dim>::Extremes(const SceneInput &input,
                          const Discretization<dim> &discretization,
                          const Communicator &communicator)
      : input_(input), discretization_(discretization),
        communicator_(communicator)
  {
    build_tables();
    // behind a front that front viscosity spreads there is hardly any tension
    constexpr double enough = 0.15;
    if (input.front_viscosity() < enough)
      front_ = sharp_front(input, discretization, communicator);
  }

  template <int dim>
  void Extremes<dim>::mesh_changed()
  {
    build_tables();
  }

  template <int dim>
  void Extremes<dim>::build_tables()
  {
    const auto &bodies = discretization_.bodies();
    gradients_.clear();
    if (!input_.large_motion && !discretization_.cells().differ())
      for (std::size_t k = 0; k < bodies.classes.size(); ++k)
        gradients_.push_back(gradient_rows(discretization_.cells().shapes[k],
                                           bodies.classes[k]));
    double largest = 0.;
    for (unsigned int b = 0; b < bodies.size(); ++b)
      for (const auto &corner : discretization_.cells().corners[b])
        for (unsigned int d = 0; d < dim; ++d)
          largest = std::max(largest, std::abs(corner[d]));
    extent_ = std::max(extent_, communicator_.max(largest));
    // implicit steps look for what they pass over, see SurfaceContacts
    has_stride_ = input_.large_motion && input_.time.scheme.at_nodes &&
                  smallest_thickness() > 0.;
  }

  /** Of all bodies and obstacles that something may fly through. 0: there is no
      such thing. */
  template <int dim>
  double Extremes<dim>::smallest_thickness() const
  {
    constexpr double none = std::numeric_limits<double>::infinity();
    double result = none;
    for (const auto &obstacle : input_.obstacles)
      result = std::min(result, obstacle.shape->thickness(obstacle));
    if (!input_.contacts.empty())
      for (const auto &[body, thickness] : body_thickness(discretization_))
        result = std::min(result, thickness);
    result = communicator_.min(result);
    return std::isfinite(result) ? result : 0.;
  }

  template <int dim>
  void Extremes<dim>::look_at_cells(const State &state)
  {
    const auto &bodies = discretization_.bodies();
    const auto &cells = discretization_.cells();
    // strains by the sum of squares first, which is never less
    double square = strain_.value * strain_.value;
    const auto look_at = [&](const Tensor<2, dim> &G, const unsigned int b,
                             const bool rigid) {
      const double turned = angle(G);
      if (!(turned <= rotation_.value))
        raise(rotation_, turned, state.time, in_space(cells.centre(b)));
      const auto strain = symmetrize(G);
      if (!rigid && !(strain * strain <= square)) {
        raise(strain_, largest_principal(G), state.time,
              in_space(cells.centre(b)));
        square = strain_.value * strain_.value;
      }
    };
    if (cells.differ() && !input_.large_motion)
      for (unsigned int b = 0; b < bodies.size(); ++b) {
        // of linear displacements: from the edges to those of their ends
        const double *u = state.displacement.data() + bodies.first_dof[b];
        Tensor<2, dim> X, U;
        for (unsigned int v = 1; v <= dim; ++v)
          for (unsigned int c = 0; c < dim; ++c) {
            X[c][v - 1] = cells.corners[b][v][c] - cells.corners[b][0][c];
            U[c][v - 1] = u[v * dim + c] - u[c];
          }
        look_at(U * invert(X), b, false);
      }
    for (std::size_t k = 0; k < gradients_.size(); ++k) {
      const BodyClass &body = bodies.classes[k];
      const std::size_t n = body.n_dofs,
                        n_places = gradients_[k].size() / (dim * dim * n);
      for (const unsigned int b : body.bodies) {
        const double *u = state.displacement.data() + bodies.first_dof[b];
        const double *row = gradients_[k].data();
        for (std::size_t p = 0; p < n_places; ++p) {
          Tensor<2, dim> G;
          for (unsigned int c = 0; c < dim; ++c)
            for (unsigned int d = 0; d < dim; ++d, row += n)
              for (std::size_t j = 0; j < n; ++j)
                G[c][d] += row[j] * u[j];
          look_at(G, b, body.rigid);
        }
      }
    }
  }

  /**
   * The box of the ways of all nodes and obstacles: no two of them pass each
   * other by more than its diagonal.
   */
  template <int dim>
  void Extremes<dim>::look_at_stride(const State &previous, const State &state)
  {
    constexpr double none = std::numeric_limits<double>::infinity();
    std::array<double, dim> low, high;
    low.fill(none);
    high.fill(-none);
    const auto widen = [&](const unsigned int d, const double way) {
      low[d] = std::min(low[d], way);
      high[d] = std::max(high[d], way);
    };
    const std::size_t n = state.displacement.size();
    // explicit steps keep their motion: there is no state before
    const bool keeps = previous.displacement.size() != n;
    for (std::size_t i = 0; i < n; ++i)
      widen(unsigned(i % dim),
            keeps ? state.last_step * state.velocity[i]
                  : state.displacement[i] - previous.displacement[i]);
    for (std::size_t o = 0; o < input_.obstacles.size(); ++o)
      for (unsigned int d = 0; d < dim; ++d)
        widen(d, state.obstacle_shift.empty() || keeps
                     ? 0.
                     : state.obstacle_shift[3 * o + d] -
                           previous.obstacle_shift[3 * o + d]);
    double square = 0.;
    for (unsigned int d = 0; d < dim; ++d) {
      const double side =
          communicator_.max(high[d]) - communicator_.min(low[d]);
      square += side * side;
    }
    raise(stride_, std::sqrt(square) / thickness_, state.time, {});
  }

  template <int dim>
  void Extremes<dim>::look_at_overlap(const State &state)
  {
    const auto widen = [this](const auto &overlap, const auto &approach) {
      for (std::size_t i = 0; i < overlap.size(); ++i)
        if (std::isfinite(overlap[i])) // else others look for its contact
          bound_ = std::max(bound_, overlap[i] + approach[i]);
    };
    widen(state.released_overlap, state.approach);
    widen(state.surface_overlap, state.surface_approach);
  }

  /** That of all ranks. Collective. */
  template <int dim>
  void Extremes<dim>::share(Peak &peak) const
  {
    if (communicator_.size() == 1)
      return;
    for (const Peak &other : gather_all(communicator_, std::vector<Peak>{peak}))
      raise(peak, other.value, other.time, other.place);
  }

  template <int dim>
  std::vector<std::string> Extremes<dim>::start(const State &state)
  {
    const auto &points = discretization_.points();
    thickness_ = has_stride_ ? smallest_thickness() : 0.;
    double largest = 0., fastest = 0.;
    for (std::size_t i = 0; i < points.n_points; ++i) {
      const PointOrigin &origin = discretization_.origins()[i];
      if (origin.kind != PointOrigin::Kind::interface ||
          input_.interfaces[origin.block].law_name != "rigid")
        continue;
      double square = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        square += std::pow(state.relative_velocity[i * dim + c], 2);
      largest = std::max(largest, square);
    }
    const auto velocity = discretization_.to_nodal(state.velocity);
    for (std::size_t i = 0; i < velocity.size(); i += dim) {
      double square = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        square += velocity[i + c] * velocity[i + c];
      fastest = std::max(fastest, square);
    }
    largest = std::sqrt(communicator_.max(largest));
    fastest = std::sqrt(communicator_.max(fastest));
    joints_ = fastest > 0. ? largest / fastest : 0.;
    std::vector<std::string> result;
    if (joints_ > largest_joint_speed)
      result.push_back(fmt::format(
          "note: at t = 0 rigidly joined points differ in velocity by {}: they "
          "meet in an impact of the first step",
          engineering(largest, "m/s")));
    if (front_)
      add_impacts(input_, discretization_, state, communicator_, *front_);
    look_at_overlap(state);
    if (!input_.large_motion)
      look_at_cells(state);
    for (auto &sentence : news())
      result.push_back(sentence);
    return result;
  }

  template <int dim>
  std::vector<std::string> Extremes<dim>::observe(const State &previous,
                                                  const State &state)
  {
    look_at_overlap(state);
    const bool in_equilibrium = !state.point_force.empty();
    if (input_.large_motion) {
      if (!has_stride_)
        return {};
      look_at_stride(previous, state);
    } else if (in_equilibrium || state.step % interval == 0)
      look_at_cells(state);
    else
      return {};
    return news();
  }

  template <int dim>
  std::vector<std::string> Extremes<dim>::finish(const State &state)
  {
    look_at_overlap(state);
    if (!input_.large_motion)
      look_at_cells(state);
    else if (has_stride_) // of explicit steps, whose motion is known now
      look_at_stride(State(), state);
    return news();
  }

  /** What has been passed, once. Collective. */
  template <int dim>
  std::vector<std::string> Extremes<dim>::news()
  {
    std::vector<std::string> result;
    const auto say = [&](Peak &peak, const double limit, bool &said,
                         const char *format, const std::string &what) {
      if (said)
        return;
      share(peak);
      if (peak.value <= limit)
        return;
      said = true;
      result.push_back(fmt::format(
          fmt::runtime("note: at t = {} near ({:.4g}, {:.4g}, {:.4g}) m " +
                       what),
          engineering(peak.time, "s"), peak.place[0], peak.place[1],
          peak.place[2], fmt::format(fmt::runtime(format), peak.value)));
    };
    if (!input_.large_motion) {
      say(rotation_, largest_rotation, said_rotation_, "{:.2g}",
          "a cell has turned by {} rad: motion = small takes rotations as "
          "small");
      say(strain_, largest_strain, said_strain_, "{:.2g}",
          "a cell has a strain of {}: motion = small takes strains as small");
    }
    if (has_stride_ && !said_stride_ && !(stride_.value < largest_stride)) {
      said_stride_ = true;
      result.push_back(fmt::format(
          "note: at t = {} bodies pass each other in a step by {:.2g} times "
          "the thickness of the thinnest: one may fly through another",
          engineering(stride_.time, "s"), stride_.value));
    }
    return result;
  }

  template <int dim>
  double Extremes<dim>::penetration_bound() const
  {
    return communicator_.max(bound_);
  }

  template <int dim>
  void Extremes<dim>::fill(RunFacts &facts) const
  {
    MotionLimits &limits = facts.limits;
    const auto &materials = input_.materials;
    if (!input_.large_motion) {
      limits.rotation = rotation_;
      share(*limits.rotation);
      if (std::any_of(materials.begin(), materials.end(),
                      [](const auto &material) { return !material.rigid; })) {
        limits.strain = strain_;
        share(*limits.strain);
      }
    }
    if (has_stride_) {
      limits.stride = stride_;
      limits.thickness = thickness_;
    }
    if (input_.may_move() &&
        std::any_of(
            input_.interfaces.begin(), input_.interfaces.end(),
            [](const auto &block) { return block.law_name == "rigid"; }))
      limits.joints = joints_;
    limits.front = front_;
    facts.extent = extent_;
  }

  template <int dim>
  void Extremes<dim>::serialize(Archive &archive)
  {
    const Archive::Part part(archive, "extremes");
    const auto visit = [&](const std::string &name, Peak &peak) {
      if (!archive.reads())
        share(peak);
      archive.numbers(name, peak.value, peak.time, peak.place[0], peak.place[1],
                      peak.place[2]);
    };
    visit("rotation", rotation_);
    visit("strain", strain_);
    visit("stride", stride_);
    if (!archive.reads())
      bound_ = communicator_.max(bound_);
    archive.numbers("values", thickness_, joints_, bound_, said_rotation_,
                    said_strain_, said_stride_);
  }

  template class Extremes<2>;
  template class Extremes<3>;
} // namespace nsfd
