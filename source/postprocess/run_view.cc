#include "run_view.h"

#include "core/gather.h"
#include "face_pieces.h"
#include "mesh/owned_cells.h"

#include "discretization/cell_geometry.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/fe/fe.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** [component][direction] of the plane into three dimensions. */
    template <int dim>
    RunView::Gradient wide(const double *gradient)
    {
      RunView::Gradient result{};
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int d = 0; d < dim; ++d)
          result[3 * c + d] = gradient[c * dim + d];
      return result;
    }
  } // namespace

  template <int dim>
  RunViewOf<dim>::RunViewOf(const SceneInput &input,
                            const Discretization<dim> &discretization,
                            const Communicator &communicator)
      : input_(input), discretization_(discretization),
        communicator_(communicator), row_(&no_row_)
  {
  }

  template <int dim>
  void RunViewOf<dim>::find(const Triangulation<dim> &triangulation,
                            const MeshGroups<dim> &groups)
  {
    samplers_.clear();
    find_points();
    find_boundary_faces(triangulation, groups);
    reach_.clear();
    for (unsigned int b = 0; b < discretization_.bodies().size(); ++b) {
      double reach = 0.;
      for (const auto &corner : discretization_.corners(b))
        reach = std::max(reach, corner.distance(discretization_.centre(b)));
      reach_.push_back(reach);
    }
  }

  template <int dim>
  void RunViewOf<dim>::find_points()
  {
    const auto &points = discretization_.points();
    points_.assign(points.n_owned, {});
    for (const auto &face : points.faces) {
      if (face.first >= points.n_owned)
        continue;
      const auto pieces = pieces_of<dim>(points, face);
      for (unsigned int k = 0; k < face.count; ++k) {
        const std::size_t i = face.first + k;
        points_[i] = {pieces[k].position, pieces[k].normal, pieces[k].ends,
                      pieces[k].area, discretization_.origins()[i]};
      }
    }
  }

  template <int dim>
  void
  RunViewOf<dim>::find_boundary_faces(const Triangulation<dim> &triangulation,
                                      const MeshGroups<dim> &groups)
  {
    boundary_faces_.assign(input_.boundaries.size(), {});
    unsigned int body = 0;
    for (const auto &cell : owned_cells(triangulation)) {
      for (const unsigned int f : cell->face_indices())
        for (unsigned int b = 0; b < input_.boundaries.size(); ++b)
          if (groups.holds_boundary_face(input_.boundaries[b].where, cell, f))
            boundary_faces_[b].push_back({{body, f}});
      ++body;
    }
  }

  template <int dim>
  void RunViewOf<dim>::show(const State &state, const State *previous,
                            const HistoryRow &row)
  {
    state_ = &state;
    // equilibria do not move; a mesh that has changed has no step behind it
    previous_ = previous && state.point_force.empty() &&
                        previous->velocity.size() == state.velocity.size()
                    ? previous
                    : nullptr;
    row_ = &row;
    motion_.reset();
    displacement_.reset();
    velocity_.reset();
    stresses_.reset();
  }

  template <int dim>
  void RunViewOf<dim>::forget()
  {
    state_ = previous_ = nullptr;
    row_ = &no_row_;
    motion_.reset();
    displacement_.reset();
    velocity_.reset();
    stresses_.reset();
  }

  template <int dim>
  const std::vector<double> &RunViewOf<dim>::displacement() const
  {
    if (!displacement_)
      displacement_ = discretization_.to_nodal(state_->displacement);
    return *displacement_;
  }

  template <int dim>
  const std::vector<double> &RunViewOf<dim>::velocity() const
  {
    if (!velocity_)
      velocity_ = discretization_.to_nodal(state_->velocity);
    return *velocity_;
  }

  template <int dim>
  CellStresses<dim> &RunViewOf<dim>::stresses() const
  {
    if (!stresses_)
      stresses_ = std::make_unique<CellStresses<dim>>(discretization_, *state_);
    return *stresses_;
  }

  template <int dim>
  const typename RunViewOf<dim>::Motion &RunViewOf<dim>::motion() const
  {
    if (motion_)
      return *motion_;
    motion_.emplace();
    std::vector<double> q = state_->displacement, v = state_->velocity,
                        a(v.size(), 0.);
    motion_->time = state_->time;
    if (previous_ && row_->time_step > 0.) {
      const double h = row_->time_step, theta = input_.time.work_theta(),
                   bulk = input_.time.bulk_theta(),
                   kick = input_.time.kick(h, previous_->last_step);
      motion_->time -= (1. - theta) * h;
      for (std::size_t k = 0; k < q.size(); ++k) {
        a[k] = (v[k] - previous_->velocity[k]) / kick;
        v[k] = theta * v[k] + (1. - theta) * previous_->velocity[k];
        q[k] = bulk * q[k] + (1. - bulk) * previous_->displacement[k];
      }
    }
    motion_->displacement = discretization_.to_nodal(q);
    motion_->velocity = discretization_.to_nodal(v);
    motion_->acceleration = discretization_.to_nodal(a);
    return *motion_;
  }

  template <int dim>
  RunView::Vector RunViewOf<dim>::traction(const std::size_t i) const
  {
    const auto &points = discretization_.points();
    const double *frame = &points.frame[i * dim * dim];
    Vector result{};
    const auto add = [&](const double factor, const double *local) {
      for (unsigned int r = 0; r < dim; ++r)
        for (unsigned int c = 0; c < dim; ++c)
          result[c] += factor * local[r] * frame[r * dim + c];
    };
    if (state_->kind[i] == PointKind::bonded)
      add(1., &state_->bond_traction[i * dim]);
    else if (!state_->point_force.empty())
      add(-1. / points.weight[i], &state_->point_force[i * dim]);
    else if (row_->time_step > 0.)
      add(-1. / (points.weight[i] * row_->time_step),
          &state_->impulse[i * dim]);
    if (!state_->pressure.empty())
      for (unsigned int c = 0; c < dim; ++c)
        result[c] -= state_->pressure[i] * frame[c];
    return result;
  }

  template <int dim>
  RunView::PointState RunViewOf<dim>::at(const std::size_t i) const
  {
    const double *frame = &discretization_.points().frame[i * dim * dim];
    PointState result;
    for (unsigned int r = 0; r < dim; ++r)
      for (unsigned int c = 0; c < dim; ++c) {
        result.jump[c] += state_->jump[i * dim + r] * frame[r * dim + c];
        result.velocity[c] +=
            state_->relative_velocity[i * dim + r] * frame[r * dim + c];
      }
    result.traction = traction(i);
    result.beta = state_->beta[i];
    result.contact = state_->contact[i] != 0;
    if (result.contact && row_->time_step > 0.)
      result.pressure = std::max(0., state_->impulse[i * dim]) /
                        (discretization_.points().weight[i] * row_->time_step);
    if (result.contact && !state_->point_force.empty())
      result.pressure = std::max(0., state_->point_force[i * dim]) /
                        discretization_.points().weight[i];
    return result;
  }

  namespace
  {
    bool is_at(const PointOrigin origin, const NamedSurface &surface)
    {
      return origin.block == surface.block &&
             origin.kind == (surface.kind == NamedSurface::Kind::obstacle
                                 ? PointOrigin::Kind::obstacle
                                 : PointOrigin::Kind::interface);
    }
  } // namespace

  template <int dim>
  bool RunViewOf<dim>::is_second(const unsigned int material,
                                 const NamedSurface &contact) const
  {
    return input_.materials[material].name ==
           input_.contacts[contact.block].materials[1];
  }

  template <int dim>
  std::vector<RunView::Place>
  RunViewOf<dim>::places(const NamedSurface &surface) const
  {
    std::vector<Place> result;
    if (surface.kind != NamedSurface::Kind::contact)
      for (std::size_t i = 0; i < points_.size(); ++i) {
        if (!is_at(points_[i].origin, surface))
          continue;
        const PointState state = at(i);
        Place &place = result.emplace_back();
        place.position = points_[i].position;
        place.normal = points_[i].normal;
        place.area = points_[i].area;
        place.contact = state.contact;
        place.pressure = state.pressure;
        for (unsigned int c = 0; c < 3; ++c) {
          place.force[c] = -place.area * state.traction[c];
          place.opening += state.jump[c] * place.normal[c];
        }
      }
    for (const SurfaceTouch &touch : state_->touches) {
      if (touch.block != surface.block ||
          touch.obstacle != (surface.kind == NamedSurface::Kind::obstacle) ||
          surface.kind == NamedSurface::Kind::interface)
        continue;
      const double sign =
          touch.obstacle || is_second(touch.material_2, surface) ? 1. : -1.;
      Place &place = result.emplace_back();
      place.position = touch.position;
      place.area = touch.weight;
      place.contact = true;
      place.opening = touch.opening;
      double normal = 0.;
      for (unsigned int c = 0; c < 3; ++c) {
        normal += touch.impulse[c] * touch.normal[c];
        place.normal[c] = sign * touch.normal[c];
        place.force[c] = sign * touch.impulse[c] / row_->time_step;
      }
      place.pressure = std::max(0., normal) / (place.area * row_->time_step);
    }
    return result;
  }

  template <int dim>
  RunView::Vector RunViewOf<dim>::reaction(const unsigned int boundary) const
  {
    const auto &driven = discretization_.driven_boundaries();
    const std::size_t first =
        dim * std::size_t(std::find(driven.begin(), driven.end(), boundary) -
                          driven.begin());
    Vector result{};
    for (unsigned int c = 0; c < dim; ++c)
      if (first + c < row_->reactions.size())
        result[c] = row_->reactions[first + c];
    return result;
  }

  template <int dim>
  double RunViewOf<dim>::broken_beta(const std::size_t i) const
  {
    const PointOrigin origin = discretization_.origins()[i];
    return origin.kind == PointOrigin::Kind::interface ? input_
                                                             .interfaces
                                                                 [origin.block]
                                                             .broken_beta()
                                                       : 0.;
  }

  template <int dim>
  const Sampler<dim> &RunViewOf<dim>::slots_of(const unsigned int body) const
  {
    const BodyShape<dim> &shape = discretization_.shape(body);
    const auto known = samplers_.find(&shape);
    if (known != samplers_.end())
      return known->second;
    return samplers_
        .emplace(&shape,
                 Sampler<dim>(discretization_.element(), shape.slot_places))
        .first->second;
  }

  /** In the order of the bodies. */
  template <int dim>
  std::vector<typename RunViewOf<dim>::Slot>
  RunViewOf<dim>::slots_on(const NamedSurface &surface) const
  {
    std::vector<Slot> slots;
    const auto add_face = [&](const unsigned int body,
                              const unsigned int face) {
      const auto &faces = discretization_.shape(body).slot_faces;
      for (unsigned int s = 0; s < faces.size(); ++s)
        if (faces[s] == face)
          slots.push_back({body, s});
    };
    if (surface.kind == NamedSurface::Kind::boundary) {
      for (const auto &face : boundary_faces_[surface.block])
        add_face(face[0], face[1]);
      return slots;
    }
    const bool is_obstacle = surface.kind == NamedSurface::Kind::obstacle;
    if (is_obstacle)
      for (const auto &face : discretization_.obstacle_faces())
        if (face.obstacle == surface.block)
          add_face(face.body, face.face);
    const Bodies &bodies = discretization_.bodies();
    const auto &origins = discretization_.origins();
    const auto is_there = [&](const unsigned int point) {
      return point < origins.size() && is_at(origins[point], surface);
    };
    for (unsigned int b = 0; b < bodies.size(); ++b)
      for (std::size_t s = bodies.first_slot[b]; s < bodies.first_slot[b + 1];
           ++s) {
        bool holds = is_there(bodies.slot_point[s]);
        for (const auto &extra : bodies.extra_points)
          holds = holds || (extra.first == s && is_there(extra.second));
        if (holds)
          slots.push_back({b, unsigned(s - bodies.first_slot[b])});
      }
    return slots;
  }

  /** Rows: weight, displacement, velocity, stress, times the weight. */
  template <int dim>
  RunView::Means RunViewOf<dim>::mean_of(const std::vector<double> &terms) const
  {
    const auto s = sums(terms, 13);
    Means means;
    means.size = s[0];
    if (!(s[0] > 0.))
      return means;
    for (unsigned int c = 0; c < 3; ++c) {
      means.displacement[c] = s[1 + c] / s[0];
      means.velocity[c] = s[4 + c] / s[0];
    }
    for (unsigned int c = 0; c < 6; ++c)
      means.stress[c] = s[7 + c] / s[0];
    return means;
  }

  namespace
  {
    /** Fills column @p k of terms with @p n columns. */
    template <int dim>
    void add_terms(std::vector<double> &terms, const std::size_t n,
                   const std::size_t k, const double weight,
                   const Tensor<1, dim> &u, const Tensor<1, dim> &v,
                   const RunView::Stress &stress)
    {
      terms[k] = weight;
      for (unsigned int c = 0; c < dim; ++c) {
        terms[(1 + c) * n + k] = weight * u[c];
        terms[(4 + c) * n + k] = weight * v[c];
      }
      for (unsigned int c = 0; c < 6; ++c)
        terms[(7 + c) * n + k] = weight * stress[c];
    }
  } // namespace

  template <int dim>
  RunView::Means RunViewOf<dim>::on(const NamedSurface &surface) const
  {
    const auto slots = slots_on(surface);
    const std::size_t n = slots.size();
    std::vector<double> terms(13 * n, 0.);
    for (std::size_t k = 0; k < n; ++k) {
      const unsigned int b = slots[k].body, s = slots[k].slot;
      const Sampler<dim> &sampler = slots_of(b);
      const double weight = discretization_.shape(b).slot_normals[s].norm();
      if (!state_) {
        terms[k] = weight;
        continue;
      }
      const std::size_t node = discretization_.first_node(b) * dim;
      const double *u = displacement().data() + node;
      add_terms<dim>(
          terms, n, k, weight, sampler.value(s, u),
          sampler.value(s, velocity().data() + node),
          stresses().at(b, sampler, s, displacement(), velocity()).stress);
    }
    return mean_of(terms);
  }

  /** In the reference cell, by Newton's iteration; nothing if outside. */
  template <int dim>
  std::optional<Point<dim>>
  RunViewOf<dim>::reference_place(const unsigned int body,
                                  const dealii::Point<dim> &x) const
  {
    constexpr double slack = 1e-9;
    if (x.distance(discretization_.centre(body)) > reach_[body] * (1. + slack))
      return {};
    const ReferenceCell cell = discretization_.element().reference_cell();
    const auto corners = discretization_.corners(body);
    dealii::Point<dim> xi = cell.template barycenter<dim>();
    for (unsigned int k = 0; k < 20; ++k)
      xi += invert(jacobian(cell, corners, xi)) *
            (x - map_point(cell, corners, xi));
    double last = 1.;
    bool inside = true;
    for (unsigned int c = 0; c < dim; ++c) {
      last -= xi[c];
      inside = inside && xi[c] >= -slack && xi[c] <= 1. + slack;
    }
    if (!inside || (cell.is_simplex() && last < -slack))
      return {};
    return xi;
  }

  template <int dim>
  RunView::Means RunViewOf<dim>::at(const Vector &place) const
  {
    dealii::Point<dim> x;
    for (unsigned int c = 0; c < dim; ++c)
      x[c] = place[c];
    std::vector<std::pair<unsigned int, dealii::Point<dim>>> cells;
    for (unsigned int b = 0; b < reach_.size(); ++b)
      if (const auto xi = reference_place(b, x))
        cells.emplace_back(b, *xi);
    const std::size_t n = cells.size();
    std::vector<double> terms(13 * n, 0.);
    for (std::size_t k = 0; k < n; ++k) {
      const unsigned int b = cells[k].first;
      if (!state_) {
        terms[k] = 1.;
        continue;
      }
      const Sampler<dim> sampler(discretization_.element(), {cells[k].second});
      const std::size_t node = discretization_.first_node(b) * dim;
      const double *u = displacement().data() + node;
      add_terms<dim>(
          terms, n, k, 1., sampler.value(0, u),
          sampler.value(0, velocity().data() + node),
          stresses().at(b, sampler, 0, displacement(), velocity()).stress);
    }
    return mean_of(terms);
  }

  template <int dim>
  bool RunViewOf<dim>::reaches(const unsigned int body, const Vector &centre,
                               const double radius) const
  {
    const auto x = discretization_.centre(body);
    double square = 0.;
    for (unsigned int c = 0; c < dim; ++c)
      square += (x[c] - centre[c]) * (x[c] - centre[c]);
    return square < (radius + reach_[body]) * (radius + reach_[body]);
  }

  template <int dim>
  void RunViewOf<dim>::visit_cells(
      const Vector &centre, const double radius,
      const std::function<void(const CellPoint &)> &visit) const
  {
    const Motion &now = motion();
    for (unsigned int b = 0; b < reach_.size(); ++b) {
      if (!reaches(b, centre, radius))
        continue;
      const BodyShape<dim> &shape = discretization_.shape(b);
      const auto &material = input_.materials[discretization_.material_of(b)];
      const std::size_t node = discretization_.first_node(b) * dim;
      const auto corner = discretization_.corners(b)[0];
      for (unsigned int q = 0; q < shape.JxW.size(); ++q) {
        CellPoint point;
        const dealii::Point<dim> x =
            corner + Tensor<1, dim>(shape.positions[q]);
        double gradient[dim * dim] = {}, rates[dim * dim] = {};
        for (unsigned int i = 0; i < shape.n_nodes; ++i) {
          const double N = shape.values[q * shape.n_nodes + i];
          const auto &g = shape.gradients[q * shape.n_nodes + i];
          for (unsigned int c = 0; c < dim; ++c) {
            const std::size_t k = node + i * dim + c;
            point.velocity[c] += N * now.velocity[k];
            point.acceleration[c] += N * now.acceleration[k];
            for (unsigned int d = 0; d < dim; ++d) {
              gradient[c * dim + d] += g[d] * now.displacement[k];
              rates[c * dim + d] += g[d] * now.velocity[k];
            }
          }
        }
        point.position = in_space<dim>(x);
        point.JxW = shape.JxW[q];
        point.density = material.density;
        point.gradient = wide<dim>(gradient);
        point.velocity_gradient = wide<dim>(rates);
        point.stress = discretization_.stress(b, x, gradient);
        for (unsigned int c = 0; c < dim; ++c) {
          point.force[c] = material.density * input_.gravity[c];
          if (!material.body_force[c].is_zero())
            point.force[c] += material.body_force[c].at(x, now.time);
        }
        visit(point);
      }
    }
  }

  template <int dim>
  void RunViewOf<dim>::visit_sides(
      const Vector &centre, const double radius,
      const std::function<void(const SidePoint &)> &visit) const
  {
    const Motion &now = motion();
    const Bodies &bodies = discretization_.bodies();
    const auto &points = discretization_.points();
    for (unsigned int b = 0; b < reach_.size(); ++b) {
      if (!reaches(b, centre, radius))
        continue;
      const auto corners = discretization_.corners(b);
      const std::size_t node = discretization_.first_node(b) * dim;
      for (std::size_t s = bodies.first_slot[b]; s < bodies.first_slot[b + 1];
           ++s) {
        const unsigned int i = bodies.slot_point[s];
        if (i >= points.n_points || points.faces[points.face_of[i]].boundary)
          continue;
        const unsigned int slot = unsigned(s - bodies.first_slot[b]);
        const Sampler<dim> &sampler = slots_of(b);
        const auto gradient =
            sampler.gradient(slot, corners, now.displacement.data() + node);
        SidePoint side;
        for (unsigned int c = 0; c < dim; ++c) {
          side.position[c] = points.position[i * dim + c];
          side.normal[c] = points.frame[i * dim * dim + c];
        }
        side.sign = bodies.slot_sign[s];
        side.area = points.weight[i];
        side.density = input_.materials[discretization_.material_of(b)].density;
        side.gradient = wide<dim>(gradient.data());
        side.velocity =
            in_space<dim>(sampler.value(slot, now.velocity.data() + node));
        side.stress = discretization_.stress(b, sampler.position(slot, corners),
                                             gradient.data());
        side.traction = traction(i);
        // as the displacements: in the middle of the step
        const double bulk = input_.time.bulk_theta();
        for (unsigned int r = 0; r < dim; ++r) {
          double u = state_->jump[i * dim + r];
          if (previous_ && row_->time_step > 0.)
            u = bulk * u + (1. - bulk) * previous_->jump[i * dim + r];
          for (unsigned int c = 0; c < dim; ++c)
            side.jump[c] += u * points.frame[(i * dim + r) * dim + c];
        }
        side.kind = state_->kind[i];
        side.beta = state_->beta[i];
        side.block = discretization_.origins()[i].block;
        side.broken_beta = input_.interfaces[side.block].broken_beta();
        visit(side);
      }
    }
  }

  template <int dim>
  std::vector<double> RunViewOf<dim>::sums(const std::vector<double> &terms,
                                           const unsigned int rows) const
  {
    return communicator_.sums(terms.data(), rows, terms.size() / rows);
  }

  template <int dim>
  double RunViewOf<dim>::max(const double value) const
  {
    return communicator_.max(value);
  }

  template <int dim>
  double RunViewOf<dim>::min(const double value) const
  {
    return communicator_.min(value);
  }

  template <int dim>
  std::vector<double>
  RunViewOf<dim>::gather(const std::vector<double> &values) const
  {
    return gather_all(communicator_, values);
  }

  template class RunViewOf<2>;
  template class RunViewOf<3>;
} // namespace nsfd
