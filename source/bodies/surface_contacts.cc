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

  template class SurfaceContacts<2>;
  template class SurfaceContacts<3>;
} // namespace nsfd
