#include "surface_contacts.h"

#include "../base/gather.h"
#include "../time/step_data.h"
#include "obstacle_shape.h"

#include "nsfd/input/scene_input.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** Interfaces, obstacles, the support, contacts: see constant_data(). */
    unsigned int interaction_of_contact(const SceneInput &input,
                                        const unsigned int block)
    {
      return unsigned(input.interfaces.size() + input.obstacles.size()) + 1 +
             block;
    }

    /// more than there are; keys of facets begin with the place of their face
    constexpr std::uint64_t pieces_per_face = 64;
  } // namespace

  template <int dim>
  SurfaceContacts<dim>::SurfaceContacts(
      const SceneInput &input, const Discretization<dim> &discretization,
      const MovingBodies<dim> &bodies, const Communicator &communicator)
      : input_(input), discretization_(discretization),
        table_(discretization.body_table()), bodies_(bodies),
        all_(communicator), cells_(discretization, bodies, communicator)
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
    search_.share(communicator,
                  [this](const unsigned int b) { return bodies_.is_own(b); });
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
    const auto edge = std::lower_bound(edges_.begin(), edges_.end(),
                                       pair_of(node_1, node_2));
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
    const auto blocks = block_by_materials_.begin() +
                        long(table_.bodies[body].material) * n;
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
    for (auto *array : {&state.surface_slip, &state.surface_overlap,
                        &state.surface_approach})
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
            state.kind[i] != PointKind::parted)
          held.insert(pair(f));
    std::vector<unsigned int> let_go;
    for (std::size_t f = 0; f < faces.size(); ++f)
      if (is_between(f) && held.count(pair(f)) == 0) {
        if (state.kind[faces[f].first] != PointKind::parted)
          let_go.insert(let_go.end(),
                        {bodies_of(f).body_1, bodies_of(f).body_2});
        for (unsigned int i = faces[f].first;
             i < faces[f].first + faces[f].count; ++i)
          state.kind[i] = PointKind::parted;
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
                 : parted_[std::size_t(f)] != 0;
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
    if (!share_parted(state) && known_) {
      if (!input_.contacts.empty())
        share_motion(state);
      return false;
    }
    known_ = true;
    joined_.clear();
    for (std::size_t f = 0; f < parted_.size(); ++f)
      if (!parted_[f]) {
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
    set_edges<dim>(
        surfaces_, x_.data(),
        [this](const unsigned int b) { return table_.is_rigid(b); });
    counters_.facets =
        std::max<unsigned long long>(counters_.facets, surfaces_.facets.size());
    return true;
  }

  /** Which faces of all ranks are parted; true if others than before. */
  template <int dim>
  bool SurfaceContacts<dim>::share_parted(const State &state)
  {
    const auto &points = discretization_.points();
    parted_.resize(cells_.mesh_faces().size(), 0);
    std::vector<int> changed;
    for (std::size_t f = 0; f < points.faces.size(); ++f) {
      const int face = cells_.mesh_face(f);
      if (face < 0 || points.faces[f].first >= points.n_owned)
        continue;
      const char now = state.kind[points.faces[f].first] == PointKind::parted;
      if (now != parted_[std::size_t(face)])
        changed.push_back(face);
    }
    if (!all_.any(!changed.empty()))
      return false;
    for (const int face : gather_all(all_, changed))
      parted_[std::size_t(face)] ^= 1;
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
    moving_nodes_.erase(
        std::unique(moving_nodes_.begin(), moving_nodes_.end()),
        moving_nodes_.end());
    own_moving_nodes_.clear();
    const auto rank_of = [this](const std::size_t node) {
      return table_
          .bodies[table_.body_of_cell[node / cells_.nodes_per_cell()]]
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
      const std::size_t k = bodies_.own_node(node);
      const Point<dim> x = bodies_.place(old, k);
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
    const auto &sides = sides_at_.at(cells_.merged(cells_.first_node(c) + node));
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
        const auto j = unsigned(
            std::find(face.nodes.begin(), face.nodes.end(), node) -
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

  // -------------------------------------------------------------------- rows

  template <int dim>
  std::vector<MovingRow<dim>>
  SurfaceContacts<dim>::rows(const State &old, const double h)
  {
    if (follow(old))
      search_.topology_changed();
    // twice the speed of two bodies that meet, and what rests
    const double reach = 2. * h * bodies_.largest_speed(old) +
                         1e-9 * discretization_.extent();
    std::vector<Row> result;
    if (!input_.contacts.empty())
      add_surface_rows(old, reach, result);
    if (!input_.obstacles.empty()) {
      auto rows = gather_all(all_, own_obstacle_rows(old, reach));
      std::sort(rows.begin(), rows.end(), [](const Row &a, const Row &b) {
        return a.index < b.index;
      });
      result.insert(result.end(), rows.begin(), rows.end());
    }
    // an explicit forecast is known already; the overlap of springs that let
    // go has to be remembered even if it is about to open
    const auto &time = input_.time;
    if (time.forecast_gamma2 == 0. && old.surface_worn.empty())
      result.erase(std::remove_if(result.begin(), result.end(),
                                  [&](const Row &row) {
                                    return !(row.released && row.gap < 0.) &&
                                           row.gap + h * time.forecast_gamma1 *
                                                         row.rate >
                                               1e-9 * discretization_.extent();
                                  }),
                   result.end());
    std::unordered_map<std::size_t, unsigned int> rows_of_edges;
    for (const Row &row : result)
      if (row.partner == Row::Partner::edge)
        ++rows_of_edges[row.place];
    for (Row &row : result)
      if (row.partner == Row::Partner::edge) {
        row.share = 1. / rows_of_edges[row.place];
        ++counters_.edge_rows;
      }
    counters_.rows += result.size();
    counters_.searches = search_.n_searches();
    for (const Row &row : result)
      counters_.largest_overlap =
          std::max(counters_.largest_overlap, -row.gap);
    return result;
  }

  template <int dim>
  Tensor<1, dim>
  SurfaceContacts<dim>::velocity(const std::size_t node) const
  {
    Vector v;
    for (unsigned int d = 0; d < dim; ++d)
      v[d] = v_[node * dim + d];
    return v;
  }

  template <int dim>
  Tensor<1, dim>
  SurfaceContacts<dim>::centre_velocity(const State &old,
                                        const unsigned int body) const
  {
    const auto r = std::size_t(table_.bodies[body].rigid);
    Vector v;
    for (unsigned int d = 0; d < dim; ++d)
      v[d] = old.rigid[13 * r + 3 + d];
    return v;
  }

  /** Of the face that a facet belongs to. */
  template <int dim>
  std::uint8_t SurfaceContacts<dim>::mark_of(const State &old,
                                             const unsigned int facet) const
  {
    return old.surface_contact[surfaces_.facets[facet].key / pieces_per_face];
  }

  /** Of a facet with this key; none of Surfaces::no_key. */
  template <int dim>
  int SurfaceContacts<dim>::body_of_key(const std::uint64_t key) const
  {
    const auto next = std::upper_bound(first_place_.begin(), first_place_.end(),
                                       key / pieces_per_face);
    return next == first_place_.end()
               ? -1
               : int(table_.body_of_cell[next - first_place_.begin() - 1]);
  }

  /** Those of the face that a facet belongs to: first and behind the last. */
  template <int dim>
  std::array<std::size_t, 2>
  SurfaceContacts<dim>::places_of_face(const unsigned int facet) const
  {
    const unsigned int cell = facet_cells_[facet];
    const std::size_t first = surfaces_.facets[facet].key / pieces_per_face;
    unsigned int face = 0;
    while (place_of(cell, face, 0) != first)
      ++face;
    return {first, first + cells_.faces(cell)[face].nodes.size()};
  }

  /**
   * Where two faces slide past each other's ends, other points go on with the
   * overlap that they have, and so does another point of the same corner when
   * its body turns: they know the bounds of those that were over the same body.
   */
  template <int dim>
  void SurfaceContacts<dim>::take_over(const FacetPair<dim> &pair,
                                       const State &old, Row &row) const
  {
    const auto &point = surfaces_.points[pair.index];
    const auto take = [&](const std::size_t place, const int over) {
      if (body_of_key(old.surface_facet[place]) != over)
        return;
      row.approach = std::max(row.approach, old.surface_approach[place]);
      row.overlap = std::max(row.overlap, old.surface_overlap[place]);
    };
    for (const bool own : {true, false}) {
      const auto places = places_of_face(own ? point.facet : pair.facet);
      for (std::size_t k = places[0]; k < places[1]; ++k)
        take(k, own ? row.body_1 : int(row.body_2));
    }
    const auto first = std::lower_bound(
        points_by_vertex_.begin(), points_by_vertex_.end(),
        std::pair(point.vertex, 0u));
    for (auto p = first;
         p != points_by_vertex_.end() && p->first == point.vertex; ++p)
      take(point_places_[p->second], row.body_1);
  }

  /** Facet and gap, and its rate with the velocities at the start. */
  template <int dim>
  void SurfaceContacts<dim>::set_partner(const FacetPair<dim> &pair,
                                         const State &old, Row &row) const
  {
    const auto &facet = surfaces_.facets[pair.facet];
    row.partner = Row::Partner::facet;
    row.body_1 = int(facet.body);
    row.facet_cell = facet_cells_[pair.facet];
    row.n_facet = facet.n_vertices;
    for (unsigned int v = 0; v < row.n_facet; ++v)
      row.facet[v] = facet.vertex[v];
    row.weights = pair.weights;
    row.gap = pair.gap;
    Vector away = row.node == Row::nowhere ? centre_velocity(old, row.body_2)
                                           : velocity(row.node);
    for (unsigned int v = 0; v < row.n_facet; ++v)
      away -= row.weights[v] * velocity(row.facet[v]);
    for (unsigned int d = 0; d < dim; ++d)
      row.rate += pair.normal[d] * away[d];
    if (row.gap < 0. && row.node != Row::nowhere) {
      if (old.surface_facet[row.place] == facet.key) {
        const double before = old.surface_gap[row.place];
        row.approach = before > 0. ? before - row.gap : 0.;
      } else {
        // it may have come in from any side in the last step, or has not been
        // seen while only a corner of it overlapped
        row.approach = old.last_step * away.norm();
        row.overlap = std::min(-row.gap, pair.inset);
        take_over(pair, old, row);
      }
    }
    row.block = unsigned(block_of(unsigned(row.body_1), row.body_2));
    row.interaction = interaction_of_contact(input_, row.block);
    row.released =
        ((old.surface_contact[row.place] | mark_of(old, pair.facet)) &
         released) != 0;
  }

  /** A point of an edge of body 2 on the edge of body 1 that it crosses. */
  template <int dim>
  MovingRow<dim>
  SurfaceContacts<dim>::edge_row(const EdgePair<dim> &pair,
                                 const State &old) const
  {
    const auto &edge = surfaces_.edges[pair.edge],
               &other = surfaces_.edges[pair.other];
    Row row;
    row.partner = Row::Partner::edge;
    row.body_1 = int(surfaces_.facets[other.facet[0]].body);
    row.body_2 = surfaces_.facets[edge.facet[0]].body;
    row.cell = facet_cells_[edge.facet[0]];
    row.facet_cell = facet_cells_[other.facet[0]];
    row.n_facet = 2;
    row.edge_weights = {1. - pair.place, pair.place};
    row.weights = {1. - pair.other_place, pair.other_place};
    std::array<Vector, 2> way;
    Vector normal, away;
    for (unsigned int v = 0; v < 2; ++v) {
      row.edge[v] = edge.vertex[v];
      row.facet[v] = other.vertex[v];
      away += row.edge_weights[v] * velocity(row.edge[v]) -
              row.weights[v] * velocity(row.facet[v]);
      const double sign = v == 0 ? -1. : 1.;
      for (unsigned int d = 0; d < dim; ++d) {
        way[0][d] += sign * x_[row.edge[v] * dim + d];
        way[1][d] += sign * x_[row.facet[v] * dim + d];
      }
    }
    for (unsigned int d = 0; d < dim; ++d)
      normal[d] = pair.normal[d];
    if constexpr (dim == 3)
      if (cross_product_3d(way[0], way[1]) * normal < 0.) {
        std::swap(row.edge[0], row.edge[1]);
        std::swap(row.edge_weights[0], row.edge_weights[1]);
      }
    row.gap = pair.gap;
    row.rate = normal * away;
    // as of a corner of a facet with these sides
    row.weight = way[0].norm() * way[1].norm() / 4.;
    row.place = place_of_edge(edge.vertex[0], edge.vertex[1]);
    row.released = ((mark_of(old, edge.facet[0]) |
                     mark_of(old, other.facet[0])) &
                    released) != 0;
    row.block = unsigned(block_of(unsigned(row.body_1), row.body_2));
    row.interaction = interaction_of_contact(input_, row.block);
    return row;
  }

  /**
   * Two corners of flat sides that face each other, as those of a face that has
   * just broken, meet once: each would ask for nearly the same, and rows that
   * almost depend on each other are what repeated steps come from. Within a
   * tenth of a side and eight degrees.
   */
  template <int dim>
  std::size_t
  SurfaceContacts<dim>::seen_from_there(const FacetPair<dim> &pair,
                                        const Row &row, const std::size_t index)
  {
    constexpr double at_corner = 0.9, opposed = -0.99;
    for (unsigned int v = 0; v < row.n_facet; ++v) {
      if (row.weights[v] < at_corner)
        continue;
      Vector normal;
      for (unsigned int d = 0; d < dim; ++d)
        normal[d] = pair.normal[d];
      const unsigned int own = cells_.merged(row.node),
                         other = unsigned(row.facet[v]);
      const auto known = seen_.find(Pair(other) << 32 | own);
      if (known != seen_.end() && known->second.normal * normal < opposed)
        return known->second.row;
      seen_.emplace(Pair(own) << 32 | other, Seen{normal, index});
    }
    return unseen;
  }

  template <int dim>
  void SurfaceContacts<dim>::add_surface_rows(const State &old,
                                              const double reach,
                                              std::vector<Row> &rows)
  {
    for (std::size_t p = 0; p < surfaces_.points.size(); ++p)
      surfaces_.points[p].last_key = old.surface_facet[point_places_[p]];
    search_.find(
        surfaces_, x_.data(), reach,
        [this](const unsigned int a, const unsigned int b) {
          return block_of(a, b) < 0 || joined_.count(pair_of(a, b)) > 0;
        },
        pairs_);
    seen_.clear();
    for (const auto &pair : pairs_.points) {
      const Origin &origin = point_origins_[pair.index];
      const auto &face = cells_.faces(origin.cell)[origin.face];
      Row row;
      row.body_2 = table_.body_of_cell[origin.cell];
      row.cell = origin.cell;
      row.node = cells_.first_node(origin.cell) + face.nodes[origin.node];
      row.weight = face.weights[origin.node];
      row.place = point_places_[pair.index];
      set_partner(pair, old, row);
      const std::size_t other = seen_from_there(pair, row, rows.size());
      if (other == unseen) {
        rows.push_back(row);
        continue;
      }
      // the deeper one is the contact
      if (row.gap < rows[other].gap)
        std::swap(rows[other], row);
      rows[other].twin = row.place;
    }
    for (const auto &pair : pairs_.balls) {
      Row row = ball_row(surfaces_.balls[pair.index].body);
      set_partner(pair, old, row);
      rows.push_back(row);
    }
    for (const auto &pair : pairs_.ball_balls) {
      Row row = ball_row(surfaces_.balls[pair.ball].body);
      row.partner = Row::Partner::ball;
      row.body_1 = int(surfaces_.balls[pair.other].body);
      row.gap = pair.gap;
      const Vector away = centre_velocity(old, row.body_2) -
                          centre_velocity(old, unsigned(row.body_1));
      for (unsigned int d = 0; d < dim; ++d)
        row.rate += pair.normal[d] * away[d];
      row.block = unsigned(block_of(unsigned(row.body_1), row.body_2));
      row.interaction = interaction_of_contact(input_, row.block);
      rows.push_back(row);
    }
    for (const auto &pair : pairs_.edges)
      rows.push_back(edge_row(pair, old));
  }

  /** Which facets points were over at the start of the step. */
  template <int dim>
  void SurfaceContacts<dim>::remember_facets(State &next) const
  {
    next.surface_facet.assign(first_place_.back(), Surfaces<dim>::no_key);
    next.surface_gap.assign(first_place_.back(), 0.);
    for (const auto &pair : pairs_.points) {
      const std::size_t place = point_places_[pair.index];
      next.surface_facet[place] = surfaces_.facets[pair.facet].key;
      next.surface_gap[place] = pair.gap;
    }
  }

  template <int dim>
  MovingRow<dim> SurfaceContacts<dim>::ball_row(const unsigned int body) const
  {
    Row row;
    row.body_2 = body;
    row.radius = cells_.ball_radius(body);
    row.place = first_place_.back() + body;
    row.weight = dim == 2 ? row.radius : row.radius * row.radius;
    return row;
  }

  /** One row per node and obstacle: that of its largest face. Their indices
      are in the order of the faces of all ranks. */
  template <int dim>
  std::vector<MovingRow<dim>>
  SurfaceContacts<dim>::own_obstacle_rows(const State &old,
                                          const double reach) const
  {
    std::vector<Row> rows;
    const auto node_place = [&](const std::size_t node) {
      return bodies_.place(old, bodies_.own_node(node));
    };
    const auto centre = [&](const unsigned int body) {
      Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = old.rigid[13 * std::size_t(table_.bodies[body].rigid) + d];
      return result;
    };
    const auto node_velocity = [&](const std::size_t node) {
      Vector v;
      for (unsigned int d = 0; d < dim; ++d)
        v[d] = old.velocity[bodies_.own_node(node) * dim + d];
      return v;
    };
    const auto geometry = [&](const unsigned int o) {
      return ObstacleGeometry<dim>(
          input_.obstacles[o],
          old.obstacle_shift.empty() ? nullptr : &old.obstacle_shift[3 * o]);
    };
    std::map<std::pair<std::size_t, unsigned int>, std::size_t> known;
    const auto add = [&](Row row, const unsigned int o) {
      const bool is_ball = row.node == Row::nowhere;
      Vector away = is_ball ? centre_velocity(old, row.body_2)
                            : node_velocity(row.node);
      for (unsigned int d = 0; d < dim; ++d)
        if (const auto &own = input_.obstacles[o].velocity[d])
          away[d] -= own->at(Point<dim>(), old.time);
      row.rate = away * geometry(o).normal(is_ball ? centre(row.body_2)
                                                   : node_place(row.node));
      row.partner = Row::Partner::obstacle;
      row.obstacle = row.block = o;
      row.interaction = unsigned(input_.interfaces.size()) + o;
      rows.push_back(row);
    };
    for (std::size_t k = 0; k < obstacle_faces_.size(); ++k) {
      const auto &[c, f, o] = obstacle_faces_[k];
      const unsigned int b = table_.body_of_cell[c];
      if (!bodies_.is_own(b))
        continue;
      if (cells_.ball_radius(b) > 0.) {
        Row row = ball_row(b);
        row.index = k * cells_.nodes_per_cell();
        row.gap = geometry(o).gap(centre(b)) - row.radius;
        if (row.gap <= reach &&
            known.emplace(std::pair(cells_.n_nodes() + b, o), 0).second)
          add(row, o);
        continue;
      }
      const FaceNodes<dim> &face = cells_.faces(c)[f];
      for (unsigned int j = 0; j < face.nodes.size(); ++j) {
        if (!is_corner(c, f, face.nodes[j]))
          continue;
        Row row;
        row.index = k * cells_.nodes_per_cell() + j;
        row.node = cells_.first_node(c) + face.nodes[j];
        row.gap = geometry(o).gap(node_place(row.node));
        if (row.gap > reach)
          continue;
        row.body_2 = b;
        row.cell = c;
        row.place = place_of(c, f, j);
        row.weight = face.weights[j];
        const auto [entry, is_new] = known.emplace(
            std::pair(std::size_t(cells_.merged(row.node)), o), rows.size());
        if (is_new)
          add(row, o);
        else if (row.weight > rows[entry->second].weight) {
          rows[entry->second].place = row.place; // the rest is that of the node
          rows[entry->second].weight = row.weight;
          rows[entry->second].cell = row.cell;
          rows[entry->second].node = row.node;
        }
      }
    }
    return rows;
  }

  template class SurfaceContacts<2>;
  template class SurfaceContacts<3>;
} // namespace nsfd
