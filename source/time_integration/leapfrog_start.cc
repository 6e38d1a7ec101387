#include "leapfrog.h"

#include "initial_state.h"
#include "joined_equilibrium.h"
#include "joined_start.h"

#include "joined/rigid_clusters.h"
#include "nsfd/scene/scene_input.h"
#include "state/point_fields.h"

#include <algorithm>

// What the steps of Leapfrog start from.

namespace nsfd
{
  namespace
  {
    bool is_interface(const PointOrigin &origin)
    {
      return origin.kind == PointOrigin::Kind::interface;
    }
  } // namespace

  template <int dim>
  State Leapfrog<dim>::initial_state() const
  {
    State state = initial_motion(input_, discretization_);
    set_jumps(discretization_, mesh_, state);
    add_initial_jumps(input_, discretization_, all_, communicator_, state);
    release_zeros(state); // before there are more lists
    const auto &points = discretization_.points();
    set_points(input_, discretization_, all_, state);
    for (std::size_t i = 0; i < points.n_points; ++i)
      if (!state.two_sided[i]) // contact holds where it is
        state.released_overlap[i] = std::max(0., -state.jump[i * dim]);
    if (large_)
      large_->set_initial(state);
    State own = ghosts_.without(std::move(state));
    own.bond_traction.assign(own.jump.size(), 0.);
    release_zeros(own);
    return own;
  }

  /** The motion and the points of @p state, with ghosts; rigid bodies get their
      velocities if they @p start. */
  template <int dim>
  void Leapfrog<dim>::take(const State &state, std::vector<std::uint8_t> intact,
                           const bool start)
  {
    if (large_)
      large_->take_histories(state);
    for (const unsigned int i :
         points_between_groups(discretization_, mesh_, hanging_, intact))
      points_.add(i, faces_.factors(i), state);
    points_.sort();
    groups_ = std::make_unique<CornerGroups<dim>>(mesh_, intact);
    rigid_.reset();
    if (input_.has_rigid_bodies())
      rigid_ = std::make_unique<RigidGroups<dim>>(
          discretization_, mesh_, communicator_, ghosts_.cells(),
          rigid_clusters(discretization_, mesh_, communicator_, ghosts_.cells(),
                         intact));
    if (rigid_ && input_.large_motion)
      rigid_->set_places(state);
    faces_.start(std::move(intact));
    groups_->gather(state.displacement, groups_->displacement);
    groups_->gather(state.velocity, groups_->velocity);
    ghosts_.fetch_motion(*groups_);
    if (hanging_.any()) {
      hanging_.tie(*groups_);
      hanging_.follow(*groups_);
    }
    find_supports();
    if (rigid_ && start)
      rigid_->start(*groups_);
    hanging_.set_forces(*forces_, *groups_);
    if (auto *viscous = forces_->viscous())
      viscous->set(*groups_, hanging_);
    before_.front = forces_->front().finish(communicator_);
    if (large_)
      large_->start(state, *groups_);
    loads_.start(state.time, state.clock, *groups_);
  }

  template <int dim>
  State Leapfrog<dim>::start_from(State given)
  {
    State state = ghosts_.with(std::move(given));
    if (has_warm_faces(input_))
      faces_.warm(ghosts_.with_points(state.heat.of_laws));
    if (input_.statics) {
      EquilibriumSprings<dim> springs(all_, mesh_);
      JoinedEquilibrium<dim>(input_, communicator_, discretization_, mesh_,
                             ghosts_, hanging_, *forces_, springs)
          .find(faces_, state);
    }
    take(state, joined_points(discretization_, state), true);
    show_at(state, {});
    const auto &g = *groups_;
    terms_.resize(g.velocity.size());
    for (std::size_t k = 0; k < terms_.size(); ++k)
      terms_[k] = g.mass[k / dim] * g.velocity[k] * g.velocity[k] / 2.;
    const double of_bodies = rigid_ ? rigid_->kinetic_energy(g, terms_) : 0.;
    state.energy.kinetic = ghosts_.sum(g, terms_) + of_bodies;
    state.energy.elastic = large_
                               ? large_->stored()
                               : -ghosts_.dot(g, g.force, g.displacement) / 2.;
    state.energy.cohesive = points_.initial_energy(communicator_);
    begin_balance(state);
    State own = ghosts_.without(std::move(state));
    release_zeros(own);
    return own;
  }

  template <int dim>
  void Leapfrog<dim>::resume_from(const State &given)
  {
    const State state = ghosts_.with(given);
    if (has_warm_faces(input_))
      faces_.warm(ghosts_.with_points(state.heat.of_laws));
    const auto &origins = discretization_.origins();
    std::vector<std::uint8_t> intact(origins.size());
    for (std::size_t i = 0; i < origins.size(); ++i)
      intact[i] =
          is_interface(origins[i]) && state.kind[i] == PointKind::bonded;
    take(state, std::move(intact), false);
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template State Leapfrog<dim>::initial_state() const;                         \
  template State Leapfrog<dim>::start_from(State);                             \
  template void Leapfrog<dim>::resume_from(const State &)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
