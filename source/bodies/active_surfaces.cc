#include "active_surfaces.h"

#include "contact_detection/flat_sides.h"
#include "contact_detection/touching_rules.h"
#include "core/disjoint_sets.h"
#include "core/gather.h"
#include "discretization/face_sizes.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  using namespace dealii;

  template <int dim>
  ActiveSurfaces<dim>::ActiveSurfaces(const SceneInput &input,
                                      const Discretization<dim> &discretization,
                                      const BodyLayout<dim> &bodies,
                                      const Communicator &communicator,
                                      const SurfaceCells<dim> &cells,
                                      const ContactPlaces<dim> &places,
                                      const ContactBlocks &blocks)
      : input_(input), discretization_(discretization),
        table_(discretization.body_table()), all_(communicator), cells_(cells),
        places_(places), blocks_(blocks),
        obstacle_for_all_(std::any_of(
            input.obstacles.begin(), input.obstacles.end(),
            [](const auto &o) { return o.where.kind == Where::Kind::all; })),
        motion_(table_, bodies, communicator, cells)
  {
  }

  template <int dim>
  bool ActiveSurfaces<dim>::is_surface(const unsigned int cell,
                                       const unsigned int face) const
  {
    const int f = cells_.kind_of(cell, face);
    return f < 0 ? f == SurfaceCells<dim>::boundary
                 : separated_[std::size_t(f)] ||
                       opening_[std::size_t(f)] == Opening::half;
  }

  /** Normals at rest of the surfaces that meet at the nodes of rigid bodies. */
  template <int dim>
  void ActiveSurfaces<dim>::set_sides()
  {
    sides_at_.clear();
    for (unsigned int c = 0; c < cells_.size(); ++c)
      for (unsigned int f = 0; f < cells_.faces(c).size(); ++f) {
        if (!table_.is_rigid(table_.body_of_cell[c]) || !is_surface(c, f))
          continue;
        const FaceNodes<dim> &face = cells_.faces(c)[f];
        for (const unsigned int node : face.nodes)
          sides_at_[cells_.merged(cells_.first_node(c) + node)].push_back(
              {c, f, face.normal});
      }
  }

  template <int dim>
  bool ActiveSurfaces<dim>::follow(const State &state)
  {
    if (!share_separated(state) && known_) {
      if (!input_.contacts.empty())
        motion_.share(state);
      return false;
    }
    known_ = true;
    joined_.clear();
    for (std::size_t f = 0; f < separated_.size(); ++f)
      if (!separated_[f]) {
        const auto &face = cells_.mesh_faces()[f];
        joined_.insert(pair_of(face.body_1, face.body_2));
      }
    set_sides();
    add_obstacle_faces();
    if (input_.contacts.empty())
      return true;
    set_pieces();
    set_surfaces();
    set_moving_nodes();
    motion_.share(state);
    const auto keeps_shape = [this](const unsigned int b) {
      return table_.is_rigid(b);
    };
    // of the leapfrog, whose contacts need the edges of bodies of many cells
    const auto has_sides = [this](const unsigned int b) {
      return input_.time.scheme.at_nodes && table_.is_rigid(b);
    };
    set_flat_sides<dim>(set_.surfaces, motion_.positions(), has_sides);
    set_edges<dim>(set_.surfaces, motion_.positions(), keeps_shape);
    return true;
  }

  /** Which faces of all ranks are separated; true if others than before. */
  template <int dim>
  bool ActiveSurfaces<dim>::share_separated(const State &state)
  {
    const auto &points = discretization_.points();
    separated_.resize(cells_.mesh_faces().size(), 0);
    opening_.resize(separated_.size(), Opening::none);
    std::vector<Change> changed;
    for (std::size_t f = 0; f < points.faces.size(); ++f) {
      const int face = cells_.mesh_face(f);
      if (face < 0 || points.faces[f].first >= points.n_owned)
        continue;
      Change now{unsigned(face), 0, opening_of(state, f)};
      for (unsigned int i = 0; i < points.faces[f].count; ++i)
        now.separated |=
            state.kind[points.faces[f].first + i] == PointKind::separated;
      if (now.separated != separated_[now.face] ||
          now.opening != opening_[now.face])
        changed.push_back(now);
    }
    if (!all_.any(!changed.empty()))
      return false;
    for (const Change &now : gather_all(all_, changed)) {
      separated_[now.face] = now.separated;
      opening_[now.face] = now.opening;
    }
    return true;
  }

  /**
   * Of face @p f of the points. Where every cell moves by itself, law points
   * keep its sides apart until it is separated, and only an obstacle may touch
   * the corners that it frees.
   */
  template <int dim>
  typename ActiveSurfaces<dim>::Opening
  ActiveSurfaces<dim>::opening_of(const State &state, const std::size_t f) const
  {
    const bool hangs_together = !wholes_.node.empty();
    const auto &points = discretization_.points().faces[f];
    Opening opening = Opening::none;
    if (!hangs_together && !obstacle_for_all_)
      return opening;
    for (unsigned int i = points.first; i < points.first + points.count; ++i) {
      const PointKind kind = state.kind[i];
      if (hangs_together && kind == PointKind::free)
        opening = Opening::half;
      else if (opening == Opening::none && !is_joined(kind) &&
               kind != PointKind::separated)
        opening = Opening::begun;
    }
    return opening;
  }

  template <int dim>
  bool ActiveSurfaces<dim>::has_opened(const unsigned int cell,
                                       const unsigned int face) const
  {
    const int f = cells_.kind_of(cell, face);
    return f >= 0 && opening_[std::size_t(f)] != Opening::none;
  }

  template <int dim>
  void ActiveSurfaces<dim>::set_surfaces()
  {
    set_.surfaces = Surfaces<dim>();
    set_.point_origins.clear();
    set_.point_places.clear();
    set_.facet_cells.clear();
    set_.facet_faces.clear();
    set_.places_by_vertex.clear();
    for (unsigned int c = 0; c < cells_.size(); ++c) {
      const unsigned int b = table_.body_of_cell[c];
      if (cells_.ball_radius(b) > 0. || !blocks_.may_touch(b))
        continue;
      for (unsigned int f = 0; f < cells_.faces(c).size(); ++f) {
        const bool touches = is_surface(c, f);
        if (touches || (!wholes_.node.empty() && has_opened(c, f)))
          add_face(c, f, touches);
      }
    }
    std::sort(set_.places_by_vertex.begin(), set_.places_by_vertex.end());
    for (unsigned int b = 0; b < table_.bodies.size(); ++b)
      if (cells_.ball_radius(b) > 0.)
        set_.surfaces.balls.push_back({b, cells_.ball_radius(b),
                                       std::uint64_t(b),
                                       unsigned(cells_.centre_node(b))});
    set_.surfaces.n_vertices = cells_.n_nodes() + table_.n_rigid;
    set_.surfaces.is_behind = [this](const unsigned int vertex,
                                     const unsigned int facet) {
      return is_behind(vertex, facet);
    };
  }

  /** Nodes whose motion all ranks need: vertices, and where contacts are. */
  template <int dim>
  void ActiveSurfaces<dim>::set_moving_nodes()
  {
    std::vector<std::size_t> nodes;
    for (const auto &facet : set_.surfaces.facets)
      nodes.insert(nodes.end(), facet.vertex.begin(),
                   facet.vertex.begin() + facet.n_vertices);
    for (const Origin &origin : set_.point_origins)
      nodes.push_back(
          cells_.first_node(origin.cell) +
          cells_.faces(origin.cell)[origin.face].nodes[origin.node]);
    motion_.set_nodes(std::move(nodes));
  }

  /** Cells of bodies between which a face holds are one piece. */
  template <int dim>
  void ActiveSurfaces<dim>::set_pieces()
  {
    if (!wholes_.of_cell.empty()) {
      piece_of_cell_ = wholes_.of_cell;
      return;
    }
    DisjointSets bodies(table_.bodies.size());
    for (std::size_t f = 0; f < separated_.size(); ++f)
      if (!separated_[f]) {
        const auto &face = cells_.mesh_faces()[f];
        bodies.join(face.body_1, face.body_2);
      }
    piece_of_cell_.resize(cells_.size());
    for (unsigned int c = 0; c < cells_.size(); ++c)
      piece_of_cell_[c] = bodies.first(table_.body_of_cell[c]);
  }

  template <int dim>
  bool ActiveSurfaces<dim>::is_corner(const unsigned int c,
                                      const unsigned int f,
                                      const unsigned int node) const
  {
    if (!table_.is_rigid(table_.body_of_cell[c]))
      return true;
    const auto &sides =
        sides_at_.at(cells_.merged(cells_.first_node(c) + node));
    const auto own = std::find_if(sides.begin(), sides.end(), [&](auto &side) {
      return side.cell == c && side.face == f;
    });
    bool all_flat = true;
    for (auto side = sides.begin(); side != sides.end(); ++side) {
      const bool parallel = side->normal * own->normal > 1. - 1e-9;
      if (parallel && side < own)
        return false;
      all_flat = all_flat && parallel;
    }
    return !all_flat;
  }

  template <int dim>
  double ActiveSurfaces<dim>::unseen_slip(const unsigned int c,
                                          const unsigned int f) const
  {
    const int face = cells_.kind_of(c, f);
    if (face < 0 || opening_[std::size_t(face)] != Opening::half)
      return 0.;
    double measure = 0.;
    for (const double weight : cells_.faces(c)[f].weights)
      measure += weight;
    return inset * face_size<dim>(measure);
  }

  template <int dim>
  void ActiveSurfaces<dim>::add_face(const unsigned int c, const unsigned int f,
                                     const bool touches)
  {
    const FaceNodes<dim> &face = cells_.faces(c)[f];
    const std::size_t first = cells_.first_node(c);
    for (unsigned int j = 0; j < face.nodes.size(); ++j)
      set_.places_by_vertex.emplace_back(merged(first + face.nodes[j]),
                                         places_.of_node(c, f, j));
    if (!touches && dim == 3) // no surface ends there
      return;
    std::vector<char> has_point(cells_.nodes_per_cell(), 0);
    for (std::size_t p = 0; p < face.pieces.size(); ++p) {
      typename Surfaces<dim>::Facet facet;
      facet.n_vertices = unsigned(face.pieces[p].size());
      for (unsigned int v = 0; v < facet.n_vertices; ++v)
        facet.vertex[v] = merged(first + face.pieces[p][v]);
      facet.body = table_.body_of_cell[c];
      facet.whole = piece_of_cell_[c];
      facet.key = std::uint64_t(places_.of_node(c, f, 0)) * pieces_per_face + p;
      facet.touches = touches;
      for (unsigned int v = 0; touches && v < facet.n_vertices; ++v) {
        const unsigned int node = face.pieces[p][v];
        if (has_point[node])
          continue;
        has_point[node] = 1;
        if (!is_corner(c, f, node))
          continue;
        set_.surfaces.points.push_back(
            {facet.vertex[v], unsigned(set_.surfaces.facets.size())});
        const auto j =
            unsigned(std::find(face.nodes.begin(), face.nodes.end(), node) -
                     face.nodes.begin());
        set_.point_origins.push_back({c, f, j});
        set_.point_places.push_back(places_.of_node(c, f, j));
      }
      set_.surfaces.facets.push_back(facet);
      set_.facet_cells.push_back(c);
      set_.facet_faces.push_back(f);
    }
  }

  /**
   * At rest the vertex lies below the facet, as near as a touch may be deep, in
   * the same piece: across a cell that is flat or a layer that is thin.
   */
  template <int dim>
  bool ActiveSurfaces<dim>::is_behind(const unsigned int vertex,
                                      const unsigned int f) const
  {
    const auto &facet = set_.surfaces.facets[f];
    if (piece_of_cell_[vertex / cells_.nodes_per_cell()] != facet.whole)
      return false;
    const std::size_t first = cells_.first_node(set_.facet_cells[f]);
    for (unsigned int node = 0; node < cells_.nodes_per_cell(); ++node)
      if (merged(first + node) == vertex)
        return true;
    std::array<double, 4 * dim> x{};
    auto local = facet;
    for (unsigned int v = 0; v < facet.n_vertices; ++v) {
      local.vertex[v] = v;
      std::copy_n(motion_.rest(facet.vertex[v]), dim, &x[v * dim]);
    }
    std::array<double, dim> y;
    std::copy_n(motion_.rest(vertex), dim, y.data());
    return is_below<dim>(local, x.data(), y);
  }

  /** Named faces, and new surfaces where the obstacle is for all. */
  template <int dim>
  void ActiveSurfaces<dim>::add_obstacle_faces()
  {
    obstacle_faces_ = cells_.obstacle_faces();
    for (unsigned int o = 0; o < input_.obstacles.size(); ++o)
      if (input_.obstacles[o].where.kind == Where::Kind::all)
        for (unsigned int c = 0; c < cells_.size(); ++c)
          for (unsigned int f = 0; f < cells_.faces(c).size(); ++f)
            if (cells_.kind_of(c, f) >= 0 &&
                (is_surface(c, f) || has_opened(c, f)))
              obstacle_faces_.push_back({c, f, o});
  }

  template class ActiveSurfaces<2>;
  template class ActiveSurfaces<3>;
} // namespace nsfd
