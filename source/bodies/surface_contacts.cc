#include "surface_contacts.h"

#include "core/gather.h"
#include "discretization/body_thickness.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  using namespace dealii;

  template <int dim>
  SurfaceContacts<dim>::SurfaceContacts(
      const SceneInput &input, const Discretization<dim> &discretization,
      const BodyLayout<dim> &bodies, const Communicator &communicator)
      : input_(input), discretization_(discretization),
        table_(discretization.body_table()), bodies_(bodies),
        all_(communicator), cells_(discretization, bodies, communicator),
        places_(cells_, table_), blocks_(input, table_),
        active_(input, discretization, bodies, communicator, cells_, places_,
                blocks_)
  {
    struct Thickness {
      unsigned int body;
      double value;
    };
    std::vector<Thickness> own;
    for (const auto &[body, value] : body_thickness(discretization))
      own.push_back({body, value});
    thickness_.resize(table_.bodies.size());
    for (const Thickness &of : gather_all(all_, own))
      thickness_[of.body] = of.value;
    search_.share(communicator,
                  [this](const unsigned int b) { return bodies_.is_own(b); });
  }

  template <int dim>
  void SurfaceContacts<dim>::set_initial(State &state) const
  {
    const std::size_t n = places_.size();
    state.surface_impulse.assign(n * dim, 0.);
    state.surface_contact.assign(n, 0);
    state.surface_facet.assign(places_.n_of_faces(), Surfaces<dim>::no_key);
    state.surface_gap.assign(places_.n_of_faces(), 0.);
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
  void SurfaceContacts<dim>::part(State &state,
                                  const std::vector<char> &alone) const
  {
    const auto &faces = discretization_.points().faces;
    const auto bodies_of = [&](const std::size_t f) {
      return cells_.mesh_faces()[std::size_t(cells_.mesh_face(f))];
    };
    const auto is_between = [&](const std::size_t f) {
      return !faces[f].boundary &&
             blocks_.of(bodies_of(f).body_1, bodies_of(f).body_2) >= 0;
    };
    const auto pair = [&](const std::size_t f) {
      return pair_of(bodies_of(f).body_1, bodies_of(f).body_2);
    };
    std::unordered_set<UnorderedPair> held;
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (unsigned int i = faces[f].first;
           is_between(f) && i < faces[f].first + faces[f].count; ++i)
        if (state.kind[i] != PointKind::free &&
            state.kind[i] != PointKind::separated)
          held.insert(pair(f));
    std::vector<unsigned int> opened;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      if (!is_between(f))
        continue;
      const bool holds = held.count(pair(f)) > 0;
      bool opens = false;
      for (unsigned int i = faces[f].first; i < faces[f].first + faces[f].count;
           ++i) {
        if (holds && (alone.empty() || !alone[i]))
          continue;
        opens = opens || state.kind[i] != PointKind::separated;
        state.kind[i] = PointKind::separated;
      }
      if (opens)
        opened.insert(opened.end(), {bodies_of(f).body_1, bodies_of(f).body_2});
    }
    if (!all_.any(!opened.empty()))
      return;
    std::vector<char> opens(table_.bodies.size(), 0);
    for (const unsigned int b : gather_all(all_, opened))
      opens[b] = 1;
    for (unsigned int c = 0; c < cells_.size(); ++c)
      if (opens[table_.body_of_cell[c]])
        for (std::size_t k = places_.first(c); k < places_.first(c + 1); ++k)
          state.surface_contact[k] |= released;
    for (unsigned int b = 0; b < opens.size(); ++b)
      if (opens[b])
        state.surface_contact[places_.of_ball(b)] |= released;
  }

  template <int dim>
  void
  SurfaceContacts<dim>::set_wholes(typename ActiveSurfaces<dim>::Wholes wholes,
                                   State &state)
  {
    const auto &before = active_.wholes().node;
    std::vector<char> split(wholes.node.size(), 0);
    for (std::size_t k = 0; k < before.size(); ++k)
      if (wholes.node[k] != before[k])
        split[before[k]] = 1;
    for (unsigned int c = 0; c < cells_.size() && !before.empty(); ++c)
      for (unsigned int f = 0; f < cells_.faces(c).size(); ++f) {
        const auto &nodes = cells_.faces(c)[f].nodes;
        for (unsigned int j = 0; j < nodes.size(); ++j)
          if (split[before[cells_.first_node(c) + nodes[j]]])
            state.surface_contact[places_.of_node(c, f, j)] |= released;
      }
    active_.set_wholes(std::move(wholes));
  }

  /** Which sides points were over at the start of the step: of several the
      one that they are deepest below. */
  template <int dim>
  void SurfaceContacts<dim>::store_facets(State &next) const
  {
    next.surface_facet.assign(places_.n_of_faces(), Surfaces<dim>::no_key);
    next.surface_gap.assign(places_.n_of_faces(), 0.);
    for (const auto &pair : pairs_.points) {
      const std::size_t place = active_.set().point_places[pair.index];
      if (next.surface_facet[place] != Surfaces<dim>::no_key &&
          next.surface_gap[place] <= pair.gap)
        continue;
      next.surface_facet[place] =
          active_.set().surfaces.facets[pair.facet].side;
      next.surface_gap[place] = pair.gap;
    }
  }

  /** Of a facet with this key; none of Surfaces::no_key. */
  template <int dim>
  int SurfaceContacts<dim>::cell_of_key(const std::uint64_t key) const
  {
    return places_.cell_of(key / ActiveSurfaces<dim>::pieces_per_face);
  }

  /** Those of the face that a facet belongs to: first and behind the last. */
  template <int dim>
  std::array<std::size_t, 2>
  SurfaceContacts<dim>::places_of_face(const unsigned int facet) const
  {
    const unsigned int cell = active_.set().facet_cells[facet],
                       face = active_.set().facet_faces[facet];
    const std::size_t first = places_.of_node(cell, face, 0);
    return {first, first + cells_.faces(cell)[face].nodes.size()};
  }

  /** The bounds of a @p place that was over the piece of cell @p over in the
      last step. */
  template <int dim>
  void SurfaceContacts<dim>::take(const State &old, const std::size_t place,
                                  const unsigned int over, Row &row) const
  {
    const int cell = cell_of_key(old.surface_facet[place]);
    if (cell < 0 || !active_.are_one_piece(unsigned(cell), over))
      return;
    row.approach = std::max(row.approach, old.surface_approach[place]);
    row.overlap = std::max(row.overlap, old.surface_overlap[place]);
  }

  template <int dim>
  void SurfaceContacts<dim>::take_at_vertex(const State &old,
                                            const unsigned int vertex,
                                            const unsigned int over,
                                            Row &row) const
  {
    const auto &places = active_.set().places_by_vertex;
    for (auto p = std::lower_bound(places.begin(), places.end(),
                                   std::pair(vertex, std::size_t(0)));
         p != places.end() && p->first == vertex; ++p)
      take(old, p->second, over, row);
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
    const auto &point = active_.set().surfaces.points[pair.index];
    for (const bool own : {true, false}) {
      const auto places = places_of_face(own ? point.facet : pair.facet);
      for (std::size_t k = places[0]; k < places[1]; ++k)
        take(old, k, own ? row.facet_cell : row.cell, row);
    }
    take_at_vertex(old, point.vertex, row.facet_cell, row);
  }

  /** How deep a corner may be before it is seen: two bodies between which
      faces still hold have slid past each other by what these allow. */
  template <int dim>
  double SurfaceContacts<dim>::unseen_depth(const FacetPair<dim> &pair) const
  {
    const auto &origin = active_.set().point_origins[pair.index];
    return std::max(pair.inset, active_.unseen_slip(origin.cell, origin.face) +
                                    active_.unseen_slip(
                                        active_.set().facet_cells[pair.facet],
                                        active_.set().facet_faces[pair.facet]));
  }

  template class SurfaceContacts<2>;
  template class SurfaceContacts<3>;
} // namespace nsfd
