#include "active_surfaces.h"

#include "contact_detection/flat_sides.h"
#include "contact_detection/touching_rules.h"
#include "core/gather.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>

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
        table_(discretization.body_table()), bodies_(bodies),
        all_(communicator), cells_(cells), places_(places), blocks_(blocks)
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
    const auto keeps_shape = [this](const unsigned int b) {
      return table_.is_rigid(b);
    };
    // of the leapfrog, whose contacts need the edges of bodies of many cells
    const auto has_sides = [this](const unsigned int b) {
      return input_.time.scheme.at_nodes && table_.is_rigid(b);
    };
    set_flat_sides<dim>(set_.surfaces, x_.data(), has_sides);
    set_edges<dim>(set_.surfaces, x_.data(), keeps_shape);
    return true;
  }

  /** Which faces of all ranks are separated; true if others than before. */
  template <int dim>
  bool ActiveSurfaces<dim>::share_separated(const State &state)
  {
    const auto &points = discretization_.points();
    separated_.resize(cells_.mesh_faces().size(), 0);
    opening_.resize(separated_.size(), Opening::none);
    std::vector<int> changed;
    for (std::size_t f = 0; f < points.faces.size(); ++f) {
      const int face = cells_.mesh_face(f);
      if (face < 0 || points.faces[f].first >= points.n_owned)
        continue;
      char now = 0;
      for (unsigned int i = 0; i < points.faces[f].count; ++i)
        now |= state.kind[points.faces[f].first + i] == PointKind::separated;
      if (!wholes_.node.empty())
        share_openings(state, f);
      if (now != separated_[std::size_t(face)])
        changed.push_back(face);
    }
    if (!all_.any(!changed.empty()))
      return false;
    for (const int face : gather_all(all_, changed))
      separated_[std::size_t(face)] ^= 1;
    return true;
  }

  /** Of face @p f of the points, whose cells hang together by nodes. */
  template <int dim>
  void ActiveSurfaces<dim>::share_openings(const State &state,
                                           const std::size_t f)
  {
    const auto &points = discretization_.points().faces[f];
    Opening opening = Opening::none;
    for (unsigned int i = points.first; i < points.first + points.count; ++i) {
      const PointKind kind = state.kind[i];
      if (kind == PointKind::free)
        opening = Opening::half;
      else if (opening == Opening::none && kind != PointKind::bonded &&
               kind != PointKind::separated)
        opening = Opening::begun;
    }
    Opening &known = opening_[std::size_t(cells_.mesh_face(f))];
    if (opening == known)
      return;
    known = opening;
    known_ = false;
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
        if (touches || has_opened(c, f))
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
    set_.surfaces.all_wholes = !wholes_.of_cell.empty();
    if (set_.surfaces.all_wholes)
      set_.surfaces.is_behind = [this](const unsigned int vertex,
                                       const unsigned int facet) {
        return is_behind(vertex, facet);
      };
  }

  /** Nodes whose motion all ranks need: vertices, and where contacts are. */
  template <int dim>
  void ActiveSurfaces<dim>::set_moving_nodes()
  {
    moving_nodes_.clear();
    for (const auto &facet : set_.surfaces.facets)
      moving_nodes_.insert(moving_nodes_.end(), facet.vertex.begin(),
                           facet.vertex.begin() + facet.n_vertices);
    for (const Origin &origin : set_.point_origins)
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
    x_.assign(set_.surfaces.n_vertices * dim, 0.);
    v_.assign(cells_.n_nodes() * dim, 0.);
  }

  /** Where the surfaces of all ranks are, and how fast. */
  template <int dim>
  void ActiveSurfaces<dim>::share_motion(const State &old)
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

  template <int dim>
  std::vector<double> ActiveSurfaces<dim>::places_in(const State &state) const
  {
    std::vector<double> own;
    own.reserve(own_moving_nodes_.size() * dim);
    for (const std::size_t node : own_moving_nodes_) {
      const Point<dim> x = bodies_.place(state, bodies_.own_node(node));
      own.insert(own.end(), x.begin_raw(), x.end_raw());
    }
    const auto places = gather_all(all_, own);
    std::vector<double> result(x_.size(), 0.);
    const double *from = places.data();
    for (const std::size_t node : moving_nodes_) {
      std::copy_n(from, dim, result.data() + node * dim);
      from += dim;
    }
    for (std::size_t r = 0; r < table_.n_rigid; ++r)
      std::copy_n(state.rigid.data() + 13 * r, dim,
                  result.data() + (cells_.n_nodes() + r) * dim);
    return result;
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
    return inset * (dim == 2 ? measure : std::sqrt(measure));
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
      facet.whole = wholes_.of_cell.empty() ? facet.body : wholes_.of_cell[c];
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
   * the same whole: across a cell that is flat or a layer that is thin.
   */
  template <int dim>
  bool ActiveSurfaces<dim>::is_behind(const unsigned int vertex,
                                      const unsigned int f) const
  {
    const auto &facet = set_.surfaces.facets[f];
    if (wholes_.of_cell[vertex / cells_.nodes_per_cell()] != facet.whole)
      return false;
    const std::size_t first = cells_.first_node(set_.facet_cells[f]);
    for (unsigned int node = 0; node < cells_.nodes_per_cell(); ++node)
      if (merged(first + node) == vertex)
        return true;
    const auto put = [this](const std::size_t node, double *x) {
      const std::size_t k = bodies_.own_node(node);
      std::copy_n(&bodies_.rest()[k * dim], dim, x);
    };
    std::array<double, 4 * dim> x{};
    auto local = facet;
    for (unsigned int v = 0; v < facet.n_vertices; ++v) {
      local.vertex[v] = v;
      put(facet.vertex[v], &x[v * dim]);
    }
    std::array<double, dim> y;
    put(vertex, y.data());
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

  template <int dim>
  Tensor<1, dim> ActiveSurfaces<dim>::velocity(const std::size_t node) const
  {
    Vector v;
    for (unsigned int d = 0; d < dim; ++d)
      v[d] = v_[node * dim + d];
    return v;
  }

  template class ActiveSurfaces<2>;
  template class ActiveSurfaces<3>;
} // namespace nsfd
