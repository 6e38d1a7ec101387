#include "surface_contacts.h"

#include "core/gather.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  using namespace dealii;

  template <int dim>
  SurfaceContacts<dim>::SurfaceContacts(
      const SceneInput &input, const Discretization<dim> &discretization,
      const MovingBodies<dim> &bodies, const Communicator &communicator)
      : input_(input), discretization_(discretization),
        table_(discretization.body_table()), bodies_(bodies),
        all_(communicator),
        cells_(discretization, bodies.layout(), communicator)
  {
    first_place_.push_back(0);
    for (unsigned int c = 0; c < cells_.size(); ++c) {
      std::size_t n = 0;
      for (const auto &face : cells_.faces(c))
        n += face.nodes.size();
      first_place_.push_back(first_place_.back() + n);
    }
    const std::size_t n = input.materials.size();
    block_by_materials_.assign(n * n, -1);
    for (std::size_t k = input.contacts.size(); k-- > 0;)
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b < n; ++b) {
          const auto &names = input.contacts[k].materials;
          const auto is = [&](const std::size_t i, const std::size_t j) {
            return names[0].empty() || (input.materials[i].name == names[0] &&
                                        input.materials[j].name == names[1]);
          };
          if (is(a, b) || is(b, a))
            block_by_materials_[a * n + b] = int(k);
        }
    if (dim == 3)
      number_edges();
    search_.share(communicator, [this](const unsigned int b) {
      return bodies_.layout().is_own(b);
    });
  }

  /** All edges of all cells: each has a place, whether it is a surface yet. */
  template <int dim>
  void SurfaceContacts<dim>::number_edges()
  {
    for (unsigned int c = 0; c < cells_.size(); ++c)
      for (const auto &face : cells_.faces(c))
        for (const auto &piece : face.pieces)
          for (std::size_t v = 0; v < piece.size(); ++v) {
            const std::size_t first = cells_.first_node(c);
            edges_.push_back(
                pair_of(cells_.merged(first + piece[v]),
                        cells_.merged(first + piece[(v + 1) % piece.size()])));
          }
    std::sort(edges_.begin(), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
  }

  /** Behind those of nodes and balls. */
  template <int dim>
  std::size_t
  SurfaceContacts<dim>::place_of_edge(const unsigned int node_1,
                                      const unsigned int node_2) const
  {
    const auto edge =
        std::lower_bound(edges_.begin(), edges_.end(), pair_of(node_1, node_2));
    return first_place_.back() + table_.bodies.size() +
           std::size_t(edge - edges_.begin());
  }

  template <int dim>
  std::size_t SurfaceContacts<dim>::place_of(const unsigned int cell,
                                             const unsigned int face,
                                             const unsigned int node) const
  {
    const auto &faces = cells_.faces(cell);
    std::size_t place = first_place_[cell] + node;
    for (unsigned int f = 0; f < face; ++f)
      place += faces[f].nodes.size();
    return place;
  }

  template <int dim>
  int SurfaceContacts<dim>::block_of(const unsigned int body_1,
                                     const unsigned int body_2) const
  {
    return block_by_materials_[table_.bodies[body_1].material *
                                   input_.materials.size() +
                               table_.bodies[body_2].material];
  }

  template <int dim>
  bool SurfaceContacts<dim>::may_touch(const unsigned int body) const
  {
    const auto n = long(input_.materials.size());
    const auto blocks =
        block_by_materials_.begin() + long(table_.bodies[body].material) * n;
    return std::any_of(blocks, blocks + n, [](const int k) { return k >= 0; });
  }

  template <int dim>
  void SurfaceContacts<dim>::set_initial(State &state) const
  {
    const std::size_t n =
        first_place_.back() + table_.bodies.size() + edges_.size();
    state.surface_impulse.assign(n * dim, 0.);
    state.surface_contact.assign(n, 0);
    state.surface_facet.assign(first_place_.back(), Surfaces<dim>::no_key);
    state.surface_gap.assign(first_place_.back(), 0.);
    for (auto *array :
         {&state.surface_slip, &state.surface_overlap, &state.surface_approach})
      array->assign(n, 0.);
    if (has_sliding_lift(input_))
      for (auto *array : {&state.surface_worn, &state.surface_wear_speed})
        array->assign(n, 0.);
    part(state);
  }

  /** Both ranks of two bodies know all faces between them. */
  template <int dim>
  void SurfaceContacts<dim>::part(State &state) const
  {
    const auto &faces = discretization_.points().faces;
    const auto bodies_of = [&](const std::size_t f) {
      return cells_.mesh_faces()[std::size_t(cells_.mesh_face(f))];
    };
    const auto is_between = [&](const std::size_t f) {
      return !faces[f].boundary &&
             block_of(bodies_of(f).body_1, bodies_of(f).body_2) >= 0;
    };
    const auto pair = [&](const std::size_t f) {
      return pair_of(bodies_of(f).body_1, bodies_of(f).body_2);
    };
    std::unordered_set<Pair> held;
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (unsigned int i = faces[f].first;
           is_between(f) && i < faces[f].first + faces[f].count; ++i)
        if (state.kind[i] != PointKind::free &&
            state.kind[i] != PointKind::separated)
          held.insert(pair(f));
    std::vector<unsigned int> let_go;
    for (std::size_t f = 0; f < faces.size(); ++f)
      if (is_between(f) && held.count(pair(f)) == 0) {
        if (state.kind[faces[f].first] != PointKind::separated)
          let_go.insert(let_go.end(),
                        {bodies_of(f).body_1, bodies_of(f).body_2});
        for (unsigned int i = faces[f].first;
             i < faces[f].first + faces[f].count; ++i)
          state.kind[i] = PointKind::separated;
      }
    if (!all_.any(!let_go.empty()))
      return;
    std::vector<char> lets_go(table_.bodies.size(), 0);
    for (const unsigned int b : gather_all(all_, let_go))
      lets_go[b] = 1;
    for (unsigned int c = 0; c < cells_.size(); ++c)
      if (lets_go[table_.body_of_cell[c]])
        for (std::size_t k = first_place_[c]; k < first_place_[c + 1]; ++k)
          state.surface_contact[k] |= released;
    for (unsigned int b = 0; b < lets_go.size(); ++b)
      if (lets_go[b])
        state.surface_contact[first_place_.back() + b] |= released;
  }

  // ---------------------------------------------------------------- surfaces

  template <int dim>
  bool SurfaceContacts<dim>::is_surface(const unsigned int cell,
                                        const unsigned int face) const
  {
    const int f = cells_.kind_of(cell, face);
    return f < 0 ? f == SurfaceCells<dim>::boundary
                 : separated_[std::size_t(f)] != 0;
  }

  /** Normals at rest of the surfaces that meet at the nodes of rigid bodies. */
  template <int dim>
  void SurfaceContacts<dim>::set_sides()
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

  /** Surfaces and their motion; true if they are others than in the last
      step. */
  template <int dim>
  bool SurfaceContacts<dim>::follow(const State &state)
  {
    if (!share_separated(state) && known_) {
      if (!input_.contacts.empty())
        share_motion(state);
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
    set_surfaces();
    set_moving_nodes();
    share_motion(state);
    set_edges<dim>(surfaces_, x_.data(),
                   [this](const unsigned int b) { return table_.is_rigid(b); });
    counters_.facets =
        std::max<unsigned long long>(counters_.facets, surfaces_.facets.size());
    return true;
  }

  /** Which faces of all ranks are separated; true if others than before. */
  template <int dim>
  bool SurfaceContacts<dim>::share_separated(const State &state)
  {
    const auto &points = discretization_.points();
    separated_.resize(cells_.mesh_faces().size(), 0);
    std::vector<int> changed;
    for (std::size_t f = 0; f < points.faces.size(); ++f) {
      const int face = cells_.mesh_face(f);
      if (face < 0 || points.faces[f].first >= points.n_owned)
        continue;
      const char now =
          state.kind[points.faces[f].first] == PointKind::separated;
      if (now != separated_[std::size_t(face)])
        changed.push_back(face);
    }
    if (!all_.any(!changed.empty()))
      return false;
    for (const int face : gather_all(all_, changed))
      separated_[std::size_t(face)] ^= 1;
    return true;
  }

  template <int dim>
  void SurfaceContacts<dim>::set_surfaces()
  {
    surfaces_ = Surfaces<dim>();
    point_origins_.clear();
    point_places_.clear();
    facet_cells_.clear();
    for (unsigned int c = 0; c < cells_.size(); ++c) {
      const unsigned int b = table_.body_of_cell[c];
      if (cells_.ball_radius(b) > 0. || !may_touch(b))
        continue;
      for (unsigned int f = 0; f < cells_.faces(c).size(); ++f)
        if (is_surface(c, f))
          add_face(c, f);
    }
    for (unsigned int b = 0; b < table_.bodies.size(); ++b)
      if (cells_.ball_radius(b) > 0.)
        surfaces_.balls.push_back({b, cells_.ball_radius(b), std::uint64_t(b),
                                   unsigned(cells_.centre_node(b))});
    surfaces_.n_vertices = cells_.n_nodes() + table_.n_rigid;
    points_by_vertex_.clear();
    for (unsigned int p = 0; p < surfaces_.points.size(); ++p)
      points_by_vertex_.emplace_back(surfaces_.points[p].vertex, p);
    std::sort(points_by_vertex_.begin(), points_by_vertex_.end());
  }

  /** Nodes whose motion all ranks need: vertices, and where contacts are. */
  template <int dim>
  void SurfaceContacts<dim>::set_moving_nodes()
  {
    moving_nodes_.clear();
    for (const auto &facet : surfaces_.facets)
      moving_nodes_.insert(moving_nodes_.end(), facet.vertex.begin(),
                           facet.vertex.begin() + facet.n_vertices);
    for (const Origin &origin : point_origins_)
      moving_nodes_.push_back(
          cells_.first_node(origin.cell) +
          cells_.faces(origin.cell)[origin.face].nodes[origin.node]);
    std::sort(moving_nodes_.begin(), moving_nodes_.end());
    moving_nodes_.erase(std::unique(moving_nodes_.begin(), moving_nodes_.end()),
                        moving_nodes_.end());
    own_moving_nodes_.clear();
    const auto rank_of = [this](const std::size_t node) {
      return table_.bodies[table_.body_of_cell[node / cells_.nodes_per_cell()]]
          .rank;
    };
    for (const std::size_t node : moving_nodes_)
      if (rank_of(node) == all_.rank())
        own_moving_nodes_.push_back(node);
    // as the ranks send them
    std::stable_sort(moving_nodes_.begin(), moving_nodes_.end(),
                     [&](const std::size_t a, const std::size_t b) {
                       return rank_of(a) < rank_of(b);
                     });
    x_.assign(surfaces_.n_vertices * dim, 0.);
    v_.assign(cells_.n_nodes() * dim, 0.);
  }

  /** Where the surfaces of all ranks are, and how fast. */
  template <int dim>
  void SurfaceContacts<dim>::share_motion(const State &old)
  {
    std::vector<double> own;
    own.reserve(own_moving_nodes_.size() * 2 * dim);
    for (const std::size_t node : own_moving_nodes_) {
      const std::size_t k = bodies_.layout().own_node(node);
      const Point<dim> x = bodies_.layout().place(old, k);
      own.insert(own.end(), x.begin_raw(), x.end_raw());
      own.insert(own.end(), old.velocity.begin() + long(k * dim),
                 old.velocity.begin() + long((k + 1) * dim));
    }
    const auto motion = gather_all(all_, own);
    const double *from = motion.data();
    for (const std::size_t node : moving_nodes_) {
      std::copy_n(from, dim, x_.data() + node * dim);
      std::copy_n(from + dim, dim, v_.data() + node * dim);
      from += 2 * dim;
    }
    for (std::size_t r = 0; r < table_.n_rigid; ++r)
      std::copy_n(old.rigid.data() + 13 * r, dim,
                  x_.data() + (cells_.n_nodes() + r) * dim);
  }

  /**
   * Flat sides of a rigid body touch with their corners: not with nodes inside
   * of them and, where several of its faces meet, with one of each direction.
   */
  template <int dim>
  bool SurfaceContacts<dim>::is_corner(const unsigned int c,
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
  void SurfaceContacts<dim>::add_face(const unsigned int c,
                                      const unsigned int f)
  {
    const FaceNodes<dim> &face = cells_.faces(c)[f];
    const std::size_t first = cells_.first_node(c);
    std::vector<char> has_point(cells_.nodes_per_cell(), 0);
    for (std::size_t p = 0; p < face.pieces.size(); ++p) {
      typename Surfaces<dim>::Facet facet;
      facet.n_vertices = unsigned(face.pieces[p].size());
      for (unsigned int v = 0; v < facet.n_vertices; ++v)
        facet.vertex[v] = cells_.merged(first + face.pieces[p][v]);
      facet.body = table_.body_of_cell[c];
      facet.key = std::uint64_t(place_of(c, f, 0)) * pieces_per_face + p;
      for (unsigned int v = 0; v < facet.n_vertices; ++v) {
        const unsigned int node = face.pieces[p][v];
        if (has_point[node])
          continue;
        has_point[node] = 1;
        if (!is_corner(c, f, node))
          continue;
        surfaces_.points.push_back(
            {facet.vertex[v], unsigned(surfaces_.facets.size())});
        const auto j =
            unsigned(std::find(face.nodes.begin(), face.nodes.end(), node) -
                     face.nodes.begin());
        point_origins_.push_back({c, f, j});
        point_places_.push_back(place_of(c, f, j));
      }
      surfaces_.facets.push_back(facet);
      facet_cells_.push_back(c);
    }
  }

  /** Named faces, and new surfaces where the obstacle is for all. */
  template <int dim>
  void SurfaceContacts<dim>::add_obstacle_faces()
  {
    obstacle_faces_ = cells_.obstacle_faces();
    for (unsigned int o = 0; o < input_.obstacles.size(); ++o)
      if (input_.obstacles[o].where.kind == Where::Kind::all)
        for (unsigned int c = 0; c < cells_.size(); ++c)
          for (unsigned int f = 0; f < cells_.faces(c).size(); ++f)
            if (cells_.kind_of(c, f) >= 0 && is_surface(c, f))
              obstacle_faces_.push_back({c, f, o});
  }

  template class SurfaceContacts<2>;
  template class SurfaceContacts<3>;
} // namespace nsfd
