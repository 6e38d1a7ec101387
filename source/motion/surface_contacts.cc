#include "surface_contacts.h"

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

    /** Of a body that is a ball; the places of balls begin at @p first. */
    template <int dim>
    MovingRow<dim> row_of_ball(const MovingBodies<dim> &bodies,
                               const std::size_t first,
                               const unsigned int body)
    {
      MovingRow<dim> row;
      const double radius = bodies.ball_radius(body);
      row.body_2 = body;
      row.place = first + body;
      row.weight = dim == 2 ? radius : radius * radius;
      return row;
    }
  } // namespace

  template <int dim>
  SurfaceContacts<dim>::SurfaceContacts(
      const SceneInput &input, const Discretization<dim> &discretization,
      const MovingBodies<dim> &bodies)
      : input_(input), discretization_(discretization), bodies_(bodies)
  {
    const auto &cells = discretization.bodies();
    for (const auto &body : cells.classes)
      faces_.push_back(
          body.bodies.empty()
              ? std::vector<FaceNodes<dim>>()
              : face_nodes(discretization.element(),
                           discretization.shape(body.bodies[0])));
    first_place_.push_back(0);
    for (std::size_t c = 0; c < cells.size(); ++c) {
      std::size_t n = 0;
      for (const auto &face : faces_[cells.class_of[c]])
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
    merge_nodes();
    if (dim == 3)
      number_edges();
    set_boundary();
  }

  /** Cells of one rigid body have their own nodes at the same places. */
  template <int dim>
  void SurfaceContacts<dim>::merge_nodes()
  {
    State rest;
    rest.displacement.assign(discretization_.n_nodal(), 0.);
    const auto x = bodies_.positions(rest);
    const double unit = 1e-9 * discretization_.extent();
    std::map<std::pair<unsigned int, std::array<long long, dim>>, unsigned int>
        first;
    merged_.resize(bodies_.n_nodes());
    for (unsigned int c = 0; c < discretization_.bodies().size(); ++c) {
      const std::size_t begin = discretization_.first_node(c);
      const unsigned int b = bodies_.body_of_cell(c);
      for (std::size_t i = begin; i < begin + discretization_.shape(c).n_nodes;
           ++i) {
        merged_[i] = unsigned(i);
        if (!bodies_.is_rigid(b))
          continue;
        std::array<long long, dim> at;
        for (unsigned int d = 0; d < dim; ++d)
          at[d] = std::llround(x[i * dim + d] / unit);
        merged_[i] =
            first.emplace(std::pair(b, at), unsigned(i)).first->second;
      }
    }
  }

  /** All edges of all cells: each has a place, whether it is a surface yet. */
  template <int dim>
  void SurfaceContacts<dim>::number_edges()
  {
    const auto &cells = discretization_.bodies();
    for (unsigned int c = 0; c < cells.size(); ++c)
      for (const auto &face : faces_[cells.class_of[c]])
        for (const auto &piece : face.pieces)
          for (std::size_t v = 0; v < piece.size(); ++v) {
            const std::size_t first = discretization_.first_node(c);
            edges_.push_back(
                pair_of(merged_[first + piece[v]],
                        merged_[first + piece[(v + 1) % piece.size()]]));
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
    return first_place_.back() + bodies_.size() +
           std::size_t(edge - edges_.begin());
  }

  template <int dim>
  void SurfaceContacts<dim>::set_boundary()
  {
    const auto &cells = discretization_.bodies();
    const auto &points = discretization_.points();
    for (unsigned int c = 0; c < cells.size(); ++c) {
      auto &face_of = mesh_face_.emplace_back(
          faces_[cells.class_of[c]].size(), boundary);
      for (std::size_t s = cells.first_slot[c]; s < cells.first_slot[c + 1];
           ++s) {
        const unsigned int i = cells.slot_point[s];
        if (i < points.n_points && discretization_.origins()[i].kind ==
                                       PointOrigin::Kind::interface)
          face_of[discretization_.face_of_slot(
              c, unsigned(s - cells.first_slot[c]))] = int(points.face_of[i]);
      }
    }
    for (const InnerFace &face : discretization_.inner_faces())
      for (unsigned int side = 0; side < 2; ++side)
        mesh_face_[face.bodies[side]][face.faces[side]] = inside;
  }

  template <int dim>
  std::size_t SurfaceContacts<dim>::place_of(const unsigned int cell,
                                             const unsigned int face,
                                             const unsigned int node) const
  {
    const auto &faces = faces_[discretization_.bodies().class_of[cell]];
    std::size_t place = first_place_[cell] + node;
    for (unsigned int f = 0; f < face; ++f)
      place += faces[f].nodes.size();
    return place;
  }

  template <int dim>
  int SurfaceContacts<dim>::block_of(const unsigned int body_1,
                                     const unsigned int body_2) const
  {
    return block_by_materials_[bodies_.material_of(body_1) *
                                   input_.materials.size() +
                               bodies_.material_of(body_2)];
  }

  template <int dim>
  void SurfaceContacts<dim>::set_initial(State &state) const
  {
    const std::size_t n =
        first_place_.back() + bodies_.size() + edges_.size();
    state.surface_impulse.assign(n * dim, 0.);
    state.surface_contact.assign(n, 0);
    for (auto *array : {&state.surface_slip, &state.surface_overlap,
                        &state.surface_approach})
      array->assign(n, 0.);
    if (!state.worn.empty())
      for (auto *array : {&state.surface_worn, &state.surface_wear_speed})
        array->assign(n, 0.);
    part(state);
  }

  template <int dim>
  void SurfaceContacts<dim>::part(State &state) const
  {
    const auto &faces = bodies_.points().faces;
    const std::size_t n_faces = discretization_.points().faces.size();
    std::unordered_set<Pair> held;
    const auto is_between = [&](const std::size_t f) {
      return faces[f].bodies[0] >= 0 && faces[f].bodies[1] >= 0 &&
             block_of(unsigned(faces[f].bodies[0]),
                      unsigned(faces[f].bodies[1])) >= 0;
    };
    const auto bodies_of = [&](const std::size_t f) {
      return pair_of(unsigned(faces[f].bodies[0]),
                     unsigned(faces[f].bodies[1]));
    };
    for (std::size_t f = 0; f < n_faces; ++f)
      for (unsigned int i = faces[f].first;
           is_between(f) && i < faces[f].first + faces[f].count; ++i)
        if (state.kind[i] != PointKind::free &&
            state.kind[i] != PointKind::parted)
          held.insert(bodies_of(f));
    std::vector<char> lets_go(bodies_.size(), 0);
    for (std::size_t f = 0; f < n_faces; ++f)
      if (is_between(f) && held.count(bodies_of(f)) == 0) {
        if (state.kind[faces[f].first] != PointKind::parted)
          for (const int b : faces[f].bodies)
            lets_go[std::size_t(b)] = 1;
        for (unsigned int i = faces[f].first;
             i < faces[f].first + faces[f].count; ++i)
          state.kind[i] = PointKind::parted;
      }
    for (unsigned int c = 0; c < mesh_face_.size(); ++c)
      if (lets_go[bodies_.body_of_cell(c)])
        for (std::size_t k = first_place_[c]; k < first_place_[c + 1]; ++k)
          state.surface_contact[k] |= released;
    for (unsigned int b = 0; b < lets_go.size(); ++b)
      if (lets_go[b])
        state.surface_contact[first_place_.back() + b] |= released;
  }

  // ---------------------------------------------------------------- surfaces

  template <int dim>
  bool SurfaceContacts<dim>::is_surface(const unsigned int cell,
                                        const unsigned int face,
                                        const State &state) const
  {
    const int f = mesh_face_[cell][face];
    if (f < 0)
      return f == boundary;
    return state.kind[bodies_.points().faces[std::size_t(f)].first] ==
           PointKind::parted;
  }

  /** Normals at rest of the surfaces that meet at the nodes of rigid bodies. */
  template <int dim>
  void SurfaceContacts<dim>::set_sides(const State &state)
  {
    sides_at_.clear();
    for (unsigned int c = 0; c < mesh_face_.size(); ++c)
      for (unsigned int f = 0; f < mesh_face_[c].size(); ++f) {
        if (!bodies_.is_rigid(bodies_.body_of_cell(c)) ||
            !is_surface(c, f, state))
          continue;
        const FaceNodes<dim> &face = faces_[discretization_.bodies().class_of[c]][f];
        for (const unsigned int node : face.nodes)
          sides_at_[merged_[discretization_.first_node(c) + node]].push_back(
              {c, f, face.normal});
      }
  }

  /** True if the surfaces are others than in the last step. */
  template <int dim>
  bool SurfaceContacts<dim>::follow(const State &state)
  {
    const auto &faces = bodies_.points().faces;
    const std::size_t n_faces = discretization_.points().faces.size();
    std::vector<char> parted(n_faces);
    for (std::size_t f = 0; f < n_faces; ++f)
      parted[f] = state.kind[faces[f].first] == PointKind::parted;
    if (known_ && parted == parted_)
      return false;
    known_ = true;
    parted_ = std::move(parted);
    joined_.clear();
    for (std::size_t f = 0; f < n_faces; ++f)
      if (!parted_[f] && faces[f].bodies[0] >= 0 && faces[f].bodies[1] >= 0)
        joined_.insert(pair_of(unsigned(faces[f].bodies[0]),
                               unsigned(faces[f].bodies[1])));
    surfaces_ = Surfaces<dim>();
    set_sides(state);
    point_origins_.clear();
    facet_cells_.clear();
    for (unsigned int c = 0; c < discretization_.bodies().size(); ++c) {
      const unsigned int b = bodies_.body_of_cell(c);
      const std::size_t n = input_.materials.size();
      const auto blocks =
          block_by_materials_.begin() + long(bodies_.material_of(b) * n);
      if (bodies_.ball_radius(b) > 0. ||
          std::all_of(blocks, blocks + long(n),
                      [](const int k) { return k < 0; }))
        continue;
      for (unsigned int f = 0; f < mesh_face_[c].size(); ++f)
        if (is_surface(c, f, state))
          add_face(c, f);
    }
    for (unsigned int b = 0; b < bodies_.size(); ++b)
      if (bodies_.ball_radius(b) > 0.)
        surfaces_.balls.push_back({b, bodies_.ball_radius(b),
                                   std::uint64_t(b),
                                   unsigned(bodies_.centre_node(b))});
    const auto x = bodies_.positions(state);
    surfaces_.n_vertices = x.size() / dim;
    set_edges<dim>(
        surfaces_, x.data(),
        [this](const unsigned int b) { return bodies_.is_rigid(b); });
    counters_.facets =
        std::max<unsigned long long>(counters_.facets, surfaces_.facets.size());
    add_obstacle_faces(state);
    return true;
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
    if (!bodies_.is_rigid(bodies_.body_of_cell(c)))
      return true;
    const auto &sides =
        sides_at_.at(merged_[discretization_.first_node(c) + node]);
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
    const FaceNodes<dim> &face = faces_[discretization_.bodies().class_of[c]][f];
    const std::size_t first = discretization_.first_node(c);
    std::vector<char> has_point(discretization_.shape(c).n_nodes, 0);
    for (std::size_t p = 0; p < face.pieces.size(); ++p) {
      typename Surfaces<dim>::Facet facet;
      facet.n_vertices = unsigned(face.pieces[p].size());
      for (unsigned int v = 0; v < facet.n_vertices; ++v)
        facet.vertex[v] = merged_[first + face.pieces[p][v]];
      facet.body = bodies_.body_of_cell(c);
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
      }
      surfaces_.facets.push_back(facet);
      facet_cells_.push_back(c);
    }
  }

  /** Named faces, and new surfaces where the obstacle is for all. */
  template <int dim>
  void SurfaceContacts<dim>::add_obstacle_faces(const State &state)
  {
    obstacle_faces_ = discretization_.obstacle_faces();
    for (unsigned int o = 0; o < input_.obstacles.size(); ++o)
      if (input_.obstacles[o].where.kind == Where::Kind::all)
        for (unsigned int c = 0; c < mesh_face_.size(); ++c)
          for (unsigned int f = 0; f < mesh_face_[c].size(); ++f)
            if (mesh_face_[c][f] >= 0 && is_surface(c, f, state))
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
    add_obstacle_rows(old, reach, result);
    // an explicit forecast is known already; the overlap of springs that let
    // go has to be remembered even if it is about to open
    const auto &time = input_.time;
    if (time.forecast_gamma2 == 0. && old.worn.empty())
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
  Tensor<1, dim> SurfaceContacts<dim>::velocity(const State &old,
                                                const std::size_t node) const
  {
    Vector v;
    for (unsigned int d = 0; d < dim; ++d)
      v[d] = old.velocity[node * dim + d];
    return v;
  }

  template <int dim>
  Tensor<1, dim>
  SurfaceContacts<dim>::centre_velocity(const State &old,
                                        const unsigned int body) const
  {
    const std::size_t r = bodies_.centre_node(body) - bodies_.n_nodes();
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
                                           : velocity(old, row.node);
    for (unsigned int v = 0; v < row.n_facet; ++v)
      away -= row.weights[v] * velocity(old, row.facet[v]);
    for (unsigned int d = 0; d < dim; ++d)
      row.rate += pair.normal[d] * away[d];
    row.block = unsigned(block_of(unsigned(row.body_1), row.body_2));
    row.interaction = interaction_of_contact(input_, row.block);
    row.released =
        ((old.surface_contact[row.place] | mark_of(old, pair.facet)) &
         released) != 0;
  }

  /** A point of an edge of body 2 on the edge of body 1 that it crosses. */
  template <int dim>
  MovingRow<dim>
  SurfaceContacts<dim>::edge_row(const EdgePair<dim> &pair, const State &old,
                                 const std::vector<double> &x) const
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
      away += row.edge_weights[v] * velocity(old, row.edge[v]) -
              row.weights[v] * velocity(old, row.facet[v]);
      const double sign = v == 0 ? -1. : 1.;
      for (unsigned int d = 0; d < dim; ++d) {
        way[0][d] += sign * x[row.edge[v] * dim + d];
        way[1][d] += sign * x[row.facet[v] * dim + d];
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
   * tenth of a side and eight degrees; what the second one may miss is less
   * than a hundredth of the side.
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
      const unsigned int own = merged_[row.node], other = row.facet[v];
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
    const auto x = bodies_.positions(old);
    search_.find(
        surfaces_, x.data(), reach,
        [this](const unsigned int a, const unsigned int b) {
          return block_of(a, b) < 0 || joined_.count(pair_of(a, b)) > 0;
        },
        pairs_);
    seen_.clear();
    for (const auto &pair : pairs_.points) {
      const Origin &origin = point_origins_[pair.index];
      const auto &face =
          faces_[discretization_.bodies().class_of[origin.cell]][origin.face];
      Row row;
      row.body_2 = bodies_.body_of_cell(origin.cell);
      row.cell = origin.cell;
      row.node = discretization_.first_node(origin.cell) +
                 face.nodes[origin.node];
      row.weight = face.weights[origin.node];
      row.place = place_of(origin.cell, origin.face, origin.node);
      set_partner(pair, old, row);
      const std::size_t other = seen_from_there(pair, row, rows.size());
      if (other == unseen)
        rows.push_back(row);
      else
        rows[other].twin = row.place;
    }
    const auto ball_row = [&](const unsigned int index) {
      return row_of_ball(bodies_, first_place_.back(),
                         surfaces_.balls[index].body);
    };
    for (const auto &pair : pairs_.balls) {
      Row row = ball_row(pair.index);
      set_partner(pair, old, row);
      rows.push_back(row);
    }
    for (const auto &pair : pairs_.ball_balls) {
      Row row = ball_row(pair.ball);
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
      rows.push_back(edge_row(pair, old, x));
  }

  /** One row per node and obstacle: that of its largest face. */
  template <int dim>
  void SurfaceContacts<dim>::add_obstacle_rows(const State &old,
                                               const double reach,
                                               std::vector<Row> &rows) const
  {
    const auto x = bodies_.positions(old);
    const auto at = [&](const std::size_t node) {
      Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = x[node * dim + d];
      return result;
    };
    const auto geometry = [&](const unsigned int o) {
      return ObstacleGeometry<dim>(
          input_.obstacles[o],
          old.obstacle_shift.empty() ? nullptr : &old.obstacle_shift[3 * o]);
    };
    std::map<std::pair<unsigned int, unsigned int>, std::size_t> known;
    const auto add = [&](Row row, const unsigned int o) {
      const bool is_ball = row.node == Row::nowhere;
      Vector away = is_ball ? centre_velocity(old, row.body_2)
                            : velocity(old, row.node);
      for (unsigned int d = 0; d < dim; ++d)
        if (const auto &own = input_.obstacles[o].velocity[d])
          away[d] -= own->at(Point<dim>(), old.time);
      row.rate = away * geometry(o).normal(at(
                            is_ball ? bodies_.centre_node(row.body_2)
                                    : row.node));
      row.partner = Row::Partner::obstacle;
      row.obstacle = row.block = o;
      row.interaction = unsigned(input_.interfaces.size()) + o;
      rows.push_back(row);
    };
    for (const auto &[c, f, o] : obstacle_faces_) {
      const unsigned int b = bodies_.body_of_cell(c);
      if (bodies_.ball_radius(b) > 0.) {
        Row row = row_of_ball(bodies_, first_place_.back(), b);
        row.gap = geometry(o).gap(at(bodies_.centre_node(b))) -
                  bodies_.ball_radius(b);
        if (row.gap <= reach &&
            known.emplace(std::pair(unsigned(bodies_.n_nodes()) + b, o), 0)
                .second)
          add(row, o);
        continue;
      }
      const FaceNodes<dim> &face = faces_[discretization_.bodies().class_of[c]][f];
      const std::size_t first = discretization_.first_node(c);
      for (unsigned int j = 0; j < face.nodes.size(); ++j) {
        if (!is_corner(c, f, face.nodes[j]))
          continue;
        Row row;
        row.node = first + face.nodes[j];
        row.gap = geometry(o).gap(at(row.node));
        if (row.gap > reach)
          continue;
        row.body_2 = b;
        row.cell = c;
        row.place = place_of(c, f, j);
        row.weight = face.weights[j];
        const auto [entry, is_new] = known.emplace(
            std::pair(merged_[row.node], o), rows.size());
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
  }

  template class SurfaceContacts<2>;
  template class SurfaceContacts<3>;
} // namespace nsfd
