#include "leapfrog.h"

#include "ghost_states.h"
#include "initial_state.h"

#include "nsfd/core/archive.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>

// What explicit steps start from, and what is kept of them.

namespace nsfd
{
  template <int dim>
  State Leapfrog<dim>::initial_state() const
  {
    State state = initial_motion(input_, discretization_);
    const auto &points = discretization_.points();
    state.jump.assign(points.n_points * dim, 0.);
    state.relative_velocity.assign(points.n_points * dim, 0.);
    for (std::size_t i = 0; i < points.n_points; ++i) {
      if (mesh_.between_sizes(i))
        continue; // one follows the other
      for (unsigned int side = 0; side < 2; ++side) {
        const unsigned int corner = mesh_.corners(i)[side];
        if (corner == JoinedMesh<dim>::none)
          continue;
        for (unsigned int r = 0; r < dim; ++r)
          for (unsigned int c = 0; c < dim; ++c) {
            const double share =
                (side == 0 ? -1. : 1.) * points.frame[(i * dim + r) * dim + c];
            state.jump[i * dim + r] +=
                share * state.displacement[corner * dim + c];
            state.relative_velocity[i * dim + r] +=
                share * state.velocity[corner * dim + c];
          }
      }
    }
    set_points(input_, discretization_, all_, state);
    for (std::size_t i = 0; i < points.n_points; ++i)
      if (!state.two_sided[i]) // contact holds where it is
        state.released_overlap[i] = std::max(0., -state.jump[i * dim]);
    return ghosts_.without(std::move(state));
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
    faces_.serialize(communicator_, archive);
    points_.serialize(archive);
    auto &front = forces_->front();
    front.serialize(archive, discretization_.bodies().first_dof);
    if (archive.reads() && front.acts()) {
      front.holds = true;
      hanging_.set_forces(*forces_, *groups_);
      front.holds = false;
    }
    archive.numbers("front", front_.before, front_.after, front_.stored,
                    front_.taken);
    archive.common("reactions", supports_.reactions());
  }

  template State Leapfrog<2>::initial_state() const;
  template void
  Leapfrog<2>::fill_counters(std::map<std::string, double> &) const;
  template void Leapfrog<2>::serialize(Archive &);
  template State Leapfrog<3>::initial_state() const;
  template void
  Leapfrog<3>::fill_counters(std::map<std::string, double> &) const;
  template void Leapfrog<3>::serialize(Archive &);
} // namespace nsfd
