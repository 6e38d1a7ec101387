#include "leapfrog.h"

#include "ghost_states.h"

#include "discretization/loads.h"
#include "joined/finite_forces.h"
#include "nsfd/core/archive.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>
#include <utility>

// What Leapfrog accounts for in a step, shows and keeps.

namespace nsfd
{
  /** Takes what viscous materials take, and sets their next forces. */
  template <int dim>
  void Leapfrog<dim>::damp(const double h, const double last,
                           Energies &energies)
  {
    const auto &g = *groups_;
    ViscousForces<dim> &viscous = *forces_->viscous();
    const double a = -ghosts_.dot(g, viscous.of_groups(), before_.velocity),
                 b = -ghosts_.dot(g, viscous.of_groups(), g.velocity);
    viscous.set(g, hanging_);
    const double c = -ghosts_.dot(g, viscous.of_groups(), g.velocity);
    energies.viscous += (h + last) / 8. * std::max(0., a + 2. * b + c);
    energies.kinetic -= h / 4. * c;
    if (last == 0.)
      energies.viscous += h / 8. * (a + c);
  }

  namespace
  {
    /** What was dissipated at the @p points (of all that are stepped), and in
        the cells on their way to the last forces. */
    template <int dim>
    void set_heat(const std::vector<std::pair<unsigned int, double>> &points,
                  const CellForces<dim> &forces,
                  const LeapfrogGhosts<dim> &ghosts, HeatState &heat)
    {
      const auto &own = ghosts.own_points();
      std::fill(heat.of_points.begin(), heat.of_points.end(), 0.);
      for (const auto &[point, energy] : points) {
        const unsigned int at = own.empty() ? point : own[point];
        if (at != unsigned(-1))
          heat.of_points[at] += energy;
      }
      const auto *flowing = dynamic_cast<const NonlinearForces<dim> *>(&forces);
      heat.of_cells.clear();
      if (!flowing || flowing->taken().empty())
        return;
      heat.of_cells = flowing->taken(); // the viscous part behind the plastic
      heat.of_cells.resize(heat.of_cells.size() / 2);
      if (const auto *layer = ghosts.layer())
        heat.of_cells = layer->own_cells(heat.of_cells);
    }
  } // namespace

  template <int dim>
  void Leapfrog<dim>::account(const State &old, const double h,
                              const Energies &bodies, State &next,
                              StepReport &report)
  {
    const auto balance = points_.account(communicator_);
    next.step = old.step + 1;
    next.time = old.time + h;
    next.last_step = h;
    EnergyLines &energy = next.energy;
    energy = old.energy;
    // h^2 v.K v / 8
    const double share = h / 8. * (bodies.power - bodies.power_after);
    energy.kinetic = bodies.kinetic - share;
    energy.elastic = bodies.stored - h / 2. * bodies.power + share;
    energy.cohesive += balance.stored + bodies.turned;
    energy.damage += balance.damage;
    energy.friction += balance.friction + bodies.friction;
    energy.impact += balance.impact + bodies.impact;
    energy.viscous += balance.viscous + bodies.viscous;
    energy.plastic += bodies.plastic;
    energy.absorbed += bodies.absorbed;
    energy.numerical += balance.numerical + bodies.numerical;
    energy.work += bodies.work + bodies.pressure_work;
    next.broken_area = old.broken_area + balance.broken;
    next.positive_friction_work = old.positive_friction_work +
                                  balance.positive_friction +
                                  bodies.positive_friction;
    next.initial_energy = old.initial_energy;
    next.penetration =
        std::max({old.penetration, balance.penetration, bodies.penetration});
    next.penetration_excess =
        std::max(old.penetration_excess,
                 std::max(balance.penetration -
                              (large_ ? large_->widen(balance.way) : 0.),
                          bodies.excess) -
                     1e-12 * discretization_.extent());
    if (input_.has_heat()) {
      next.heat.of_points.resize((own_ ? *own_ : all_).n_points);
      set_heat(balance.heat, *forces_, ghosts_, next.heat);
    }
    next.rigid_drift = old.rigid_drift;
    next.viscous_traction = old.viscous_traction;
    next.pressure_work = old.pressure_work + bodies.pressure_work;
    report.active = balance.active + bodies.touching;
    report.beyond_unique |= balance.beyond_unique;
    report.changes = balance.changes;
    report.changes.taken[std::size_t(WatchedLine::scheme)] =
        energy.numerical - old.energy.numerical;
    // the way of a law over two steps has their mean velocity only if both have
    // one length; the first step of all has its own way
    const bool other_length = old.last_step > 0. && h != old.last_step;
    report.changes.taken[std::size_t(WatchedLine::large_motion)] =
        bodies.large + (other_length ? balance.numerical : 0.);
    report.changes.worst[std::size_t(WatchedLine::large_motion)] =
        LineChanges::no_point;
    report.changes.taken[std::size_t(WatchedLine::friction)] += bodies.friction;
    report.changes.taken[std::size_t(WatchedLine::impact)] += bodies.impact;
    report.changes.taken[std::size_t(WatchedLine::viscous)] =
        energy.viscous - old.energy.viscous;
    report.changes.taken[std::size_t(WatchedLine::plastic)] = bodies.plastic;
    close_balance(old, next, report);
    double scale = 4. * std::abs(energy.kinetic);
    if (rigid_ && input_.large_motion) { // bodies at rest have no other energy
      scale = std::max(scale, 2. * rigid_->sizes().motion);
      relate_defect(scale, next, report);
    }
    if (discretization_.loads().initial_stress()) {
      // what holds the faces gives nothing, to the last bits of what it holds
      const auto &g = *groups_;
      const auto &loads = loads_.of_groups();
      const double kick = (h + old.last_step) / 2.;
      terms_.assign(g.force.size(), 0.);
      for (std::size_t k = 0; k < terms_.size(); ++k)
        if (const double m = g.mass[k / dim]; m > 0.) {
          const double impulse = kick * (g.force[k] + loads[k]);
          terms_[k] = impulse * impulse / m;
        }
      scale = std::max(scale, ghosts_.sum(g, terms_));
      relate_defect(scale, next, report);
    }
    const TakenStep step{old, next, h, scale, 0};
    check_.check_balance(step, report);
    check_.watch_energy(step, report);
    // bodies at rest: their contacts are solved to
    // LeapfrogContacts::part_of_tolerance of the tolerance, and what that
    // leaves of the work is no energy either
    if (rigid_ && input_.large_motion)
      report.changes.terms += LeapfrogContacts<dim>::part_of_tolerance *
                              input_.solver.tolerance *
                              rigid_->sizes().impulses / round_off_of_step(1.);
  }

  /** Bodies and tractions with ghosts, points where they have a place. */
  template <int dim>
  void Leapfrog<dim>::show_at(State &state,
                              const std::vector<unsigned int> &place) const
  {
    groups_->scatter(groups_->displacement, state.displacement);
    groups_->scatter(groups_->velocity, state.velocity);
    points_.chains().show(state, place);
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
    if (!groups_)
      return; // it could not start
    show_at(state, ghosts_.own_points());
    if (loads_.cracks())
      loads_.cracks()->show(ghosts_.own_points(), state);
    if (large_)
      large_->show(state);
    if (rigid_ && input_.large_motion)
      rigid_->show(state);
    const auto *layer = ghosts_.layer();
    if (!layer)
      return;
    state.displacement = layer->own_unknowns(state.displacement);
    state.velocity = layer->own_unknowns(state.velocity);
    state.material_history = layer->own_histories(state.material_history);
    state.bond_traction = layer->own_points(state.bond_traction, dim);
    ghosts_.count_once(state);
  }

  template <int dim>
  void
  Leapfrog<dim>::fill_counters(std::map<std::string, double> &counters) const
  {
    counters["node_problems"] = double(counters_.problems);
    counters["gauss_seidel_sweeps"] = double(counters_.sweeps);
    counters["newton"] = double(counters_.newton);
    counters["released_points"] = double(counters_.released);
    std::size_t n_points = 0;
    for (const unsigned int point : points_.chains().point)
      n_points += mesh_.counts(mesh_.node_of_point(point));
    counters["active_points"] = double(communicator_.sum_integer(n_points));
    counters["node_problems_above_1e-12"] = double(counters_.inexact);
    counters["held_node_problems"] = double(counters_.held);
    counters["groups"] = double(communicator_.sum_integer(
        groups_ ? groups_->size() - groups_->not_counted().size() : 0));
    counters["worst_excess_over_strength"] =
        communicator_.max(counters_.excess);
    if (large_)
      large_->fill_counters(counters);
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
    archive.numbers("front", before_.front.before, before_.front.after,
                    before_.front.stored, before_.front.taken);
    archive.common("reactions", supports_.reactions());
    if (rigid_)
      rigid_->serialize(archive);
    if (large_)
      large_->serialize(archive, points_);
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template void Leapfrog<dim>::damp(double, double, Energies &);               \
  template void Leapfrog<dim>::account(                                        \
      const State &, double, const Energies &, State &, StepReport &);         \
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
