#include "viewed_mesh.h"

#include "discretization/cells.h"
#include "discretization/obstacle_of_point.h"
#include "mesh/owned_cells.h"

#include "discretization/cell_geometry.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/fe/fe.h>

#include <algorithm>

namespace nsfd
{
  using namespace dealii;

  bool is_at(const SceneInput &input, const PointOrigin origin,
             const NamedSurface &surface)
  {
    if (surface.kind == NamedSurface::Kind::obstacle)
      return obstacle_of(input, origin) == int(surface.block);
    return origin.block == surface.block &&
           origin.kind == PointOrigin::Kind::interface;
  }

  template <int dim>
  void ViewedMesh<dim>::find(const Triangulation<dim> &triangulation,
                             const MeshGroups<dim> &groups)
  {
    samplers_.clear();
    find_boundary_faces(triangulation, groups);
    reach_.clear();
    for (unsigned int b = 0; b < discretization_.bodies().size(); ++b) {
      double reach = 0.;
      const Point<dim> centre = discretization_.cells().centre(b);
      for (const auto &corner : discretization_.cells().corners[b])
        reach = std::max(reach, corner.distance(centre));
      reach_.push_back(reach);
    }
  }

  template <int dim>
  void
  ViewedMesh<dim>::find_boundary_faces(const Triangulation<dim> &triangulation,
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
  const Sampler<dim> &ViewedMesh<dim>::slots_of(const unsigned int body) const
  {
    const unsigned int k = discretization_.bodies().class_of[body];
    const auto known = samplers_.find(k);
    if (known != samplers_.end())
      return known->second;
    return samplers_
        .emplace(k, Sampler<dim>(*discretization_.cells().element,
                                 discretization_.cells().shapes[k].slot_places))
        .first->second;
  }

  /** In the order of the bodies. */
  template <int dim>
  std::vector<typename ViewedMesh<dim>::Slot>
  ViewedMesh<dim>::slots_on(const NamedSurface &surface) const
  {
    std::vector<Slot> slots;
    const auto add_face = [&](const unsigned int body,
                              const unsigned int face) {
      const auto &faces = discretization_.cells().class_shape(body).slot_faces;
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
      return point < origins.size() && is_at(input_, origins[point], surface);
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

  /** In the reference cell, by Newton's iteration; nothing if outside. */
  template <int dim>
  std::optional<Point<dim>>
  ViewedMesh<dim>::reference_place(const unsigned int body,
                                   const dealii::Point<dim> &x) const
  {
    constexpr double slack = 1e-9;
    if (x.distance(discretization_.cells().centre(body)) >
        reach_[body] * (1. + slack))
      return {};
    const ReferenceCell cell =
        discretization_.cells().element->reference_cell();
    const auto corners = discretization_.cells().corners[body];
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
  auto ViewedMesh<dim>::cells_at(const RunView::Vector &place) const
      -> std::vector<CellPlace>
  {
    dealii::Point<dim> x;
    for (unsigned int c = 0; c < dim; ++c)
      x[c] = place[c];
    std::vector<CellPlace> cells;
    for (unsigned int b = 0; b < reach_.size(); ++b)
      if (const auto xi = reference_place(b, x))
        cells.push_back({b, *xi});
    return cells;
  }

  template <int dim>
  std::vector<unsigned int>
  ViewedMesh<dim>::cells_in(const RunView::Vector &centre,
                            const double radius) const
  {
    std::vector<unsigned int> cells;
    for (unsigned int b = 0; b < reach_.size(); ++b) {
      const auto x = discretization_.cells().centre(b);
      double square = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        square += (x[c] - centre[c]) * (x[c] - centre[c]);
      if (square < (radius + reach_[b]) * (radius + reach_[b]))
        cells.push_back(b);
    }
    return cells;
  }

  template class ViewedMesh<2>;
  template class ViewedMesh<3>;
} // namespace nsfd
