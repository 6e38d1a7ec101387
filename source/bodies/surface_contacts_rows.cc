#include "surface_contacts.h"

#include "contact_detection/touching_rules.h"
#include "core/gather.h"
#include "obstacle_geometry.h"
#include "settle_corners.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>
#include <map>

// SurfaceContacts: which contacts there are in a step.

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
  } // namespace

  template <int dim>
  std::vector<MovingRow<dim>> SurfaceContacts<dim>::rows(const State &old,
                                                         const double h,
                                                         const double speed)
  {
    if (active_.follow(old)) {
      search_.topology_changed();
      counters_.facets = std::max<unsigned long long>(
          counters_.facets, active_.set().surfaces.facets.size());
    }
    // twice the speed of two bodies that meet, and what rests
    const double reach = 2. * h * speed + 1e-9 * discretization_.extent();
    std::vector<Row> result;
    if (!input_.contacts.empty())
      add_surface_rows(old, reach, result);
    if (!input_.obstacles.empty()) {
      auto rows = gather_all(all_, own_obstacle_rows(old, reach));
      std::sort(rows.begin(), rows.end(),
                [](const Row &a, const Row &b) { return a.index < b.index; });
      result.insert(result.end(), rows.begin(), rows.end());
    }
    // an explicit forecast is known already; the overlap of springs that let
    // go has to be kept even if it is about to open
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
      counters_.largest_overlap = std::max(counters_.largest_overlap, -row.gap);
    return result;
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
    return old.surface_contact[active_.set().surfaces.facets[facet].key /
                               ActiveSurfaces<dim>::pieces_per_face];
  }

  /** Facet and gap, and its rate with the velocities at the start. */
  template <int dim>
  void SurfaceContacts<dim>::set_partner(const FacetPair<dim> &pair,
                                         const State &old, Row &row) const
  {
    const auto &facet = active_.set().surfaces.facets[pair.facet];
    row.partner = Row::Partner::facet;
    row.body_1 = int(facet.body);
    row.facet_cell = active_.set().facet_cells[pair.facet];
    row.n_facet = facet.n_vertices;
    for (unsigned int v = 0; v < row.n_facet; ++v)
      row.facet[v] = facet.vertex[v];
    row.weights = pair.weights;
    row.gap = pair.gap;
    Vector away = row.node == Row::nowhere
                      ? centre_velocity(old, row.body_2)
                      : active_.motion().velocity(row.node);
    for (unsigned int v = 0; v < row.n_facet; ++v)
      away -= row.weights[v] * active_.motion().velocity(row.facet[v]);
    for (unsigned int d = 0; d < dim; ++d)
      row.rate += pair.normal[d] * away[d];
    if (row.gap < 0. && row.node != Row::nowhere) {
      if (old.surface_facet[row.place] == facet.side) {
        // what nothing pushed in the last step has closed in it
        const double before = old.surface_gap[row.place];
        const bool pushed = (old.surface_contact[row.place] & touches) != 0;
        row.approach =
            before > 0. || !pushed ? std::max(0., before - row.gap) : 0.;
      } else {
        // it may have come in from any side in the last step, or has not been
        // seen while only a corner of it overlapped
        Vector way = active_.motion().last_way(row.node);
        for (unsigned int v = 0; v < row.n_facet; ++v)
          way -= row.weights[v] * active_.motion().last_way(row.facet[v]);
        row.approach = way.norm();
        row.overlap = std::min(-row.gap, unseen_depth(pair));
        take_over(pair, old, row);
      }
    }
    row.block = unsigned(blocks_.of(unsigned(row.body_1), row.body_2));
    row.interaction = interaction_of_contact(input_, row.block);
    row.released =
        ((old.surface_contact[row.place] | mark_of(old, pair.facet)) &
         released) != 0;
  }

  /** By the nodes of its own cell: vertices may be those of another one. */
  template <int dim>
  std::size_t SurfaceContacts<dim>::place_of_edge(
      const typename Surfaces<dim>::Edge &edge) const
  {
    const std::size_t first =
        cells_.first_node(active_.set().facet_cells[edge.facet[0]]);
    std::array<unsigned int, 2> node = edge.vertex;
    for (unsigned int i = 0; i < cells_.nodes_per_cell(); ++i)
      for (unsigned int v = 0; v < 2; ++v)
        if (active_.merged(first + i) == edge.vertex[v])
          node[v] = cells_.merged(first + i);
    return places_.of_edge(node[0], node[1]);
  }

  /** A point of an edge of body 2 on the edge of body 1 that it crosses. */
  template <int dim>
  MovingRow<dim> SurfaceContacts<dim>::edge_row(const EdgePair<dim> &pair,
                                                const State &old) const
  {
    const auto &edge = active_.set().surfaces.edges[pair.edge],
               &other = active_.set().surfaces.edges[pair.other];
    Row row;
    row.partner = Row::Partner::edge;
    row.body_1 = int(active_.set().surfaces.facets[other.facet[0]].body);
    row.body_2 = active_.set().surfaces.facets[edge.facet[0]].body;
    row.cell = active_.set().facet_cells[edge.facet[0]];
    row.facet_cell = active_.set().facet_cells[other.facet[0]];
    row.n_facet = 2;
    row.edge_weights = {1. - pair.place, pair.place};
    row.weights = {1. - pair.other_place, pair.other_place};
    std::array<Vector, 2> way;
    Vector normal, away, last_way;
    for (unsigned int v = 0; v < 2; ++v) {
      row.edge[v] = edge.vertex[v];
      row.facet[v] = other.vertex[v];
      away += row.edge_weights[v] * active_.motion().velocity(row.edge[v]) -
              row.weights[v] * active_.motion().velocity(row.facet[v]);
      last_way += row.edge_weights[v] * active_.motion().last_way(row.edge[v]) -
                  row.weights[v] * active_.motion().last_way(row.facet[v]);
      const double sign = v == 0 ? -1. : 1.;
      for (unsigned int d = 0; d < dim; ++d) {
        way[0][d] += sign * active_.motion().positions()[row.edge[v] * dim + d];
        way[1][d] +=
            sign * active_.motion().positions()[row.facet[v] * dim + d];
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
    if (row.gap < 0.) {
      // bodies that turn touch with corners first, then with edges, and what is
      // nearly flat has no edge yet
      row.approach = last_way.norm();
      row.overlap =
          std::min(-row.gap, crease * std::sqrt(way[0].norm() * way[1].norm()));
      for (unsigned int v = 0; v < 2; ++v) {
        take_at_vertex(old, edge.vertex[v], row.facet_cell, row);
        take_at_vertex(old, other.vertex[v], row.cell, row);
      }
    }
    // as of a corner of a facet with these sides
    row.weight = way[0].norm() * way[1].norm() / 4.;
    row.place = place_of_edge(edge);
    row.released =
        ((mark_of(old, edge.facet[0]) | mark_of(old, other.facet[0])) &
         released) != 0;
    row.block = unsigned(blocks_.of(unsigned(row.body_1), row.body_2));
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
  std::size_t SurfaceContacts<dim>::seen_from_there(const FacetPair<dim> &pair,
                                                    const Row &row,
                                                    const std::size_t index)
  {
    constexpr double at_corner = 0.9, opposed = -0.99;
    for (unsigned int v = 0; v < row.n_facet; ++v) {
      if (row.weights[v] < at_corner)
        continue;
      Vector normal;
      for (unsigned int d = 0; d < dim; ++d)
        normal[d] = pair.normal[d];
      const unsigned int own = active_.merged(row.node),
                         other = unsigned(row.facet[v]);
      const auto known = seen_.find(UnorderedPair(other) << 32 | own);
      if (known != seen_.end() && known->second.normal * normal < opposed)
        return known->second.row;
      seen_.emplace(UnorderedPair(own) << 32 | other, Seen{normal, index});
    }
    return unseen;
  }

  template <int dim>
  void SurfaceContacts<dim>::add_surface_rows(const State &old,
                                              const double reach,
                                              std::vector<Row> &rows)
  {
    for (std::size_t p = 0; p < active_.set().surfaces.points.size(); ++p) {
      auto &point = active_.set().surfaces.points[p];
      point.last_side = old.surface_facet[active_.set().point_places[p]];
      point.was_below = old.surface_gap[active_.set().point_places[p]] < 0.;
    }
    search_.find(
        active_.set().surfaces, active_.motion().positions(), reach,
        [this](const unsigned int a, const unsigned int b) {
          return blocks_.of(a, b) < 0 || active_.are_joined(a, b);
        },
        pairs_);
    settle_corners(active_, 1e-9 * discretization_.extent(), pairs_.points);
    seen_.clear();
    for (const auto &pair : pairs_.points) {
      const auto &origin = active_.set().point_origins[pair.index];
      const auto &face = cells_.faces(origin.cell)[origin.face];
      Row row;
      row.body_2 = table_.body_of_cell[origin.cell];
      row.cell = origin.cell;
      row.node = cells_.first_node(origin.cell) + face.nodes[origin.node];
      row.weight = face.weights[origin.node];
      row.place = active_.set().point_places[pair.index];
      set_partner(pair, old, row);
      const std::size_t other = seen_from_there(pair, row, rows.size());
      if (other == unseen) {
        rows.push_back(row);
        continue;
      }
      // the deeper one is the contact; of equal ones the first, or round-off
      // would give it another history in every step
      if (row.gap < rows[other].gap - 1e-12 * discretization_.extent())
        std::swap(rows[other], row);
      rows[other].twin = row.place;
    }
    for (const auto &pair : pairs_.balls) {
      Row row = ball_row(active_.set().surfaces.balls[pair.index].body);
      set_partner(pair, old, row);
      rows.push_back(row);
    }
    for (const auto &pair : pairs_.ball_balls) {
      Row row = ball_row(active_.set().surfaces.balls[pair.ball].body);
      row.partner = Row::Partner::ball;
      row.body_1 = int(active_.set().surfaces.balls[pair.other].body);
      row.gap = pair.gap;
      const Vector away = centre_velocity(old, row.body_2) -
                          centre_velocity(old, unsigned(row.body_1));
      for (unsigned int d = 0; d < dim; ++d)
        row.rate += pair.normal[d] * away[d];
      row.block = unsigned(blocks_.of(unsigned(row.body_1), row.body_2));
      row.interaction = interaction_of_contact(input_, row.block);
      rows.push_back(row);
    }
    for (const auto &pair : pairs_.edges)
      rows.push_back(edge_row(pair, old));
  }

  template <int dim>
  MovingRow<dim> SurfaceContacts<dim>::ball_row(const unsigned int body) const
  {
    Row row;
    row.body_2 = body;
    row.radius = cells_.ball_radius(body);
    row.place = places_.of_ball(body);
    row.weight = dim == 2 ? row.radius : row.radius * row.radius;
    return row;
  }

  /**
   * One row per node and obstacle: that of its largest face. Its impulse is
   * kept by the face which lies nearest to the obstacle, apart from those of
   * what the other faces of a corner touch. Their indices are in the order of
   * the faces of all ranks.
   */
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
    std::vector<double> heights; // of the faces of rows
    std::vector<double> gaps;    // of the nodes of a face
    const auto add = [&](Row row, const unsigned int o) {
      const bool is_ball = row.node == Row::nowhere;
      Vector away =
          is_ball ? centre_velocity(old, row.body_2) : node_velocity(row.node);
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
    for (std::size_t k = 0; k < active_.obstacle_faces().size(); ++k) {
      const auto &[c, f, o] = active_.obstacle_faces()[k];
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
      gaps.clear();
      double height = 0.;
      for (const unsigned int node : face.nodes) {
        gaps.push_back(
            geometry(o).gap(node_place(cells_.first_node(c) + node)));
        height += gaps.back() / double(face.nodes.size());
      }
      for (unsigned int j = 0; j < face.nodes.size(); ++j) {
        if (!active_.is_corner(c, f, face.nodes[j]))
          continue;
        Row row;
        row.index = k * cells_.nodes_per_cell() + j;
        row.node = cells_.first_node(c) + face.nodes[j];
        row.gap = gaps[j];
        if (row.gap > reach)
          continue;
        row.body_2 = b;
        row.cell = c;
        row.place = places_.of_node(c, f, j);
        row.weight = face.weights[j];
        // a crack face that has just opened is to know what its node knew
        row.approach = old.surface_approach[row.place];
        row.overlap = old.surface_overlap[row.place];
        const auto [entry, is_new] = known.emplace(
            std::pair(std::size_t(active_.merged(row.node)), o), rows.size());
        if (is_new) {
          add(row, o);
          heights.resize(rows.size());
          heights.back() = height;
          rows.back().place_of_impulse = row.place;
          continue;
        }
        Row &same = rows[entry->second];
        same.approach = std::max(same.approach, row.approach);
        same.overlap = std::max(same.overlap, row.overlap);
        if (row.weight > same.weight) {
          same.place = row.place; // the rest is that of the node
          same.weight = row.weight;
          same.cell = row.cell;
          same.node = row.node;
        }
        if (height < heights[entry->second]) {
          same.place_of_impulse = row.place;
          heights[entry->second] = height;
        }
      }
    }
    return rows;
  }

#define INSTANTIATE(dim)                                                       \
  template std::vector<MovingRow<dim>> SurfaceContacts<dim>::rows(             \
      const State &, double, double)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
