#include "run_view.h"

#include "core/gather.h"
#include "discretization/cells.h"
#include "face_pieces.h"

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
        communicator_(communicator), mesh_(input, discretization),
        motion_(input, discretization)
  {
  }

  template <int dim>
  void RunViewOf<dim>::find(const Triangulation<dim> &triangulation,
                            const MeshGroups<dim> &groups)
  {
    mesh_.find(triangulation, groups);
    find_points();
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
  RunView::PointState RunViewOf<dim>::at(const std::size_t i) const
  {
    const double *frame = discretization_.points().axes(i);
    const State &state = *motion_.state();
    PointState result;
    for (unsigned int r = 0; r < dim; ++r)
      for (unsigned int c = 0; c < dim; ++c) {
        result.jump[c] += state.jump[i * dim + r] * frame[r * dim + c];
        result.velocity[c] +=
            state.relative_velocity[i * dim + r] * frame[r * dim + c];
      }
    result.traction = motion_.traction(i);
    result.beta = state.beta[i];
    result.contact = state.contact[i] != 0;
    if (result.contact && motion_.row().time_step > 0.)
      result.pressure =
          std::max(0., state.impulse[i * dim]) /
          (discretization_.points().weight[i] * motion_.row().time_step);
    if (result.contact && !state.point_force.empty())
      result.pressure = std::max(0., state.point_force[i * dim]) /
                        discretization_.points().weight[i];
    return result;
  }

  namespace
  {
    bool is_second(const SceneInput &input, const unsigned int material,
                   const NamedSurface &contact)
    {
      return input.materials[material].name ==
             input.contacts[contact.block].materials[1];
    }
  } // namespace

  template <int dim>
  std::vector<RunView::Place>
  RunViewOf<dim>::places(const NamedSurface &surface) const
  {
    std::vector<Place> result;
    if (surface.kind != NamedSurface::Kind::contact)
      for (std::size_t i = 0; i < points_.size(); ++i) {
        if (!is_at(input_, points_[i].origin, surface))
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
    for (const SurfaceTouch &touch : motion_.state()->touches) {
      if (touch.block != surface.block ||
          touch.obstacle != (surface.kind == NamedSurface::Kind::obstacle) ||
          surface.kind == NamedSurface::Kind::interface)
        continue;
      const double sign =
          touch.obstacle || is_second(input_, touch.material_2, surface) ? 1.
                                                                         : -1.;
      Place &place = result.emplace_back();
      place.position = touch.position;
      place.area = touch.weight;
      place.contact = true;
      place.opening = touch.opening;
      double normal = 0.;
      for (unsigned int c = 0; c < 3; ++c) {
        normal += touch.impulse[c] * touch.normal[c];
        place.normal[c] = sign * touch.normal[c];
        place.force[c] = sign * touch.impulse[c] / motion_.row().time_step;
      }
      place.pressure =
          std::max(0., normal) / (place.area * motion_.row().time_step);
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
      if (first + c < motion_.row().reactions.size())
        result[c] = motion_.row().reactions[first + c];
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

  namespace
  {
    /** Rows: weight, displacement, velocity, stress, times the weight. */
    RunView::Means mean_of(const RunView &view,
                           const std::vector<double> &terms)
    {
      const auto s = view.sums(terms, 13);
      RunView::Means means;
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
    const auto slots = mesh_.slots_on(surface);
    const std::size_t n = slots.size();
    std::vector<double> terms(13 * n, 0.);
    for (std::size_t k = 0; k < n; ++k) {
      const unsigned int b = slots[k].body, s = slots[k].slot;
      const Sampler<dim> &sampler = mesh_.slots_of(b);
      const auto shape = discretization_.cells().shape(b);
      const double weight = slot_area(*shape, s);
      if (!motion_.state()) {
        terms[k] = weight;
        continue;
      }
      const std::size_t node = discretization_.cells().first_node[b] * dim;
      const double *u = motion_.displacement().data() + node;
      add_terms<dim>(
          terms, n, k, weight, sampler.value(s, u),
          sampler.value(s, motion_.velocity().data() + node),
          motion_.stresses()
              .at(b, sampler, s, motion_.displacement(), motion_.velocity())
              .stress);
    }
    return mean_of(*this, terms);
  }

  template <int dim>
  RunView::Means RunViewOf<dim>::at(const Vector &place) const
  {
    const auto cells = mesh_.cells_at(place);
    const std::size_t n = cells.size();
    std::vector<double> terms(13 * n, 0.);
    for (std::size_t k = 0; k < n; ++k) {
      const unsigned int b = cells[k].body;
      if (!motion_.state()) {
        terms[k] = 1.;
        continue;
      }
      const Sampler<dim> sampler(*discretization_.cells().element,
                                 {cells[k].reference});
      const std::size_t node = discretization_.cells().first_node[b] * dim;
      const double *u = motion_.displacement().data() + node;
      add_terms<dim>(
          terms, n, k, 1., sampler.value(0, u),
          sampler.value(0, motion_.velocity().data() + node),
          motion_.stresses()
              .at(b, sampler, 0, motion_.displacement(), motion_.velocity())
              .stress);
    }
    return mean_of(*this, terms);
  }

  template <int dim>
  void RunViewOf<dim>::visit_cells(
      const Vector &centre, const double radius,
      const std::function<void(const CellPoint &)> &visit) const
  {
    const auto &now = motion_.middle();
    for (const unsigned int b : mesh_.cells_in(centre, radius)) {
      const auto of_body = discretization_.cells().shape(b);
      const BodyShape<dim> &shape = *of_body;
      const auto &material =
          input_.materials[discretization_.cells().body_class(b).material];
      const std::size_t node = discretization_.cells().first_node[b] * dim;
      const auto corner = discretization_.cells().corners[b][0];
      for (unsigned int q = 0; q < shape.JxW.size(); ++q) {
        CellPoint point;
        const dealii::Point<dim> x =
            corner + Tensor<1, dim>(shape.positions[q]);
        double value[dim] = {}, gradient[dim * dim] = {}, rates[dim * dim] = {};
        for (unsigned int i = 0; i < shape.n_nodes; ++i) {
          const double N = shape.values[q * shape.n_nodes + i];
          const auto &g = shape.gradients[q * shape.n_nodes + i];
          for (unsigned int c = 0; c < dim; ++c) {
            const std::size_t k = node + i * dim + c;
            value[c] += N * now.displacement[k];
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
        point.stress = discretization_.stress(b, x, value, gradient);
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
    const auto &now = motion_.middle();
    const State &state = *motion_.state();
    const State *previous = motion_.previous();
    const Bodies &bodies = discretization_.bodies();
    const auto &points = discretization_.points();
    for (const unsigned int b : mesh_.cells_in(centre, radius)) {
      const auto corners = discretization_.cells().corners[b];
      const std::size_t node = discretization_.cells().first_node[b] * dim;
      for (std::size_t s = bodies.first_slot[b]; s < bodies.first_slot[b + 1];
           ++s) {
        const unsigned int i = bodies.slot_point[s];
        if (i >= points.n_points || points.faces[points.face_of[i]].boundary)
          continue;
        const unsigned int slot = unsigned(s - bodies.first_slot[b]);
        const Sampler<dim> &sampler = mesh_.slots_of(b);
        const auto gradient =
            sampler.gradient(slot, corners, now.displacement.data() + node);
        SidePoint side;
        for (unsigned int c = 0; c < dim; ++c) {
          side.position[c] = points.position[i * dim + c];
          side.normal[c] = points.axes(i)[c];
        }
        side.sign = bodies.slot_sign[s];
        side.area = points.weight[i];
        side.density =
            input_.materials[discretization_.cells().body_class(b).material]
                .density;
        side.gradient = wide<dim>(gradient.data());
        side.velocity =
            in_space<dim>(sampler.value(slot, now.velocity.data() + node));
        side.stress = discretization_.stress(
            b, sampler.position(slot, corners),
            sampler.value(slot, now.displacement.data() + node).begin_raw(),
            gradient.data());
        side.traction = motion_.traction(i);
        // as the displacements: in the middle of the step
        const double theta = input_.time.theta;
        for (unsigned int r = 0; r < dim; ++r) {
          double u = state.jump[i * dim + r];
          if (previous && motion_.row().time_step > 0.)
            u = theta * u + (1. - theta) * previous->jump[i * dim + r];
          for (unsigned int c = 0; c < dim; ++c)
            side.jump[c] += u * points.axes(i)[r * dim + c];
        }
        side.kind = state.kind[i];
        side.beta = state.beta[i];
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
