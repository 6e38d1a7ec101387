#include "leapfrog.h"

#include "ghost_states.h"

#include "nsfd/core/archive.h"

// What a run shows of Leapfrog and keeps of it.

namespace nsfd
{
  /** Bodies and tractions with ghosts, points where they have a place. */
  template <int dim>
  void Leapfrog<dim>::show_at(State &state,
                              const std::vector<unsigned int> &place) const
  {
    groups_->scatter(groups_->displacement, state.displacement);
    groups_->scatter(groups_->velocity, state.velocity);
    points_.show(state, place);
    const auto &origins = discretization_.origins();
    state.bond_traction.resize(origins.size() * dim);
    faces_.show(*forces_, state.bond_traction);
    for (std::size_t i = 0; i < origins.size(); ++i) {
      if (origins[i].kind != PointOrigin::Kind::motion)
        continue;
      const unsigned int at = place.empty() ? unsigned(i) : place[i];
      if (at == unsigned(-1))
        continue;
      const unsigned int group = groups_->of(mesh_.a_corner(i));
      for (unsigned int c = 0; c < dim; ++c) { // its axes are x, y, z
        state.jump[std::size_t(at) * dim + c] =
            groups_->displacement[group * dim + c];
        state.relative_velocity[std::size_t(at) * dim + c] =
            groups_->velocity[group * dim + c];
      }
    }
  }

  template <int dim>
  void Leapfrog<dim>::show(State &state) const
  {
    show_at(state, ghosts_.own_points());
    const auto *layer = ghosts_.layer();
    if (!layer)
      return;
    state.displacement = layer->own_unknowns(state.displacement);
    state.velocity = layer->own_unknowns(state.velocity);
    state.bond_traction = layer->own_points(state.bond_traction, dim);
  }

  template <int dim>
  void
  Leapfrog<dim>::fill_counters(std::map<std::string, double> &counters) const
  {
    counters["node_problems"] = double(counters_.problems);
    counters["gauss_seidel_sweeps"] = double(counters_.sweeps);
    counters["newton"] = double(counters_.newton);
    counters["released_points"] = double(counters_.released);
    counters["active_points"] =
        double(communicator_.sum_integer(points_.n_counted()));
    counters["node_problems_above_1e-12"] = double(counters_.loose);
    counters["groups"] = double(communicator_.sum_integer(
        groups_ ? groups_->size() - groups_->not_counted().size() : 0));
    counters["worst_excess_over_strength"] =
        communicator_.max(counters_.excess);
  }

  template <int dim>
  void Leapfrog<dim>::serialize(Archive &archive)
  {
    if (!ghosts_.layer())
      return serialize_all(archive);
    GhostArchive<dim> all(*ghosts_.layer(), archive);
    serialize_all(all);
  }

  template <int dim>
  void Leapfrog<dim>::serialize_all(Archive &archive)
  {
    const Archive::Part part(archive, "leapfrog");
    counters_.excess = communicator_.max(counters_.excess);
    archive.numbers("excess", counters_.excess);
    faces_.serialize(archive);
    points_.serialize(archive);
    auto &front = forces_->front();
    front.serialize(archive, discretization_.bodies().first_dof);
    if (archive.reads() && front.acts()) {
      front.holds = true;
      forces_->set_forces(*groups_);
      front.holds = false;
    }
    archive.numbers("front", front_.before, front_.after, front_.stored,
                    front_.taken);
    archive.common("reactions", supports_.reactions());
    if (rigid_)
      rigid_->serialize(archive);
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template void Leapfrog<dim>::show(State &) const;                            \
  template void Leapfrog<dim>::show_at(                                        \
      State &, const std::vector<unsigned int> &) const;                       \
  template void Leapfrog<dim>::fill_counters(std::map<std::string, double> &)  \
      const;                                                                   \
  template void Leapfrog<dim>::serialize(Archive &)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
