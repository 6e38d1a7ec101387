#include "leapfrog.h"

#include "ghost_states.h"
#include "joined_start.h"
#include "point_name.h"
#include "step_data.h"

#include "core/cost.h"
#include "core/stopwatch.h"
#include "discretization/loads.h"
#include "nsfd/core/archive.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    bool is_interface(const PointOrigin &origin)
    {
      return origin.kind == PointOrigin::Kind::interface;
    }

    /** Without what only steps of all points need. */
    template <int dim>
    OneStepProblem<dim> point_data(const SceneInput &input,
                                   const Discretization<dim> &discretization)
    {
      auto problem = constant_data(input, discretization);
      const auto drop = [](auto &...arrays) {
        ((arrays = std::decay_t<decltype(arrays)>()), ...);
      };
      drop(problem.kind, problem.mask, problem.contact, problem.opening_max,
           problem.compression_stiffness, problem.target, problem.free_velocity,
           problem.given_velocity, problem.jump_old, problem.jump_free,
           problem.sliding_offset, problem.majorant_normal,
           problem.majorant_tangential);
      return problem;
    }
  } // namespace

  template <int dim>
  Leapfrog<dim>::Leapfrog(const SceneInput &input,
                          const Discretization<dim> &discretization,
                          const Communicator &communicator,
                          std::unique_ptr<const GhostLayer<dim>> layer)
      : input_(input), communicator_(communicator),
        ghosts_(communicator, discretization, std::move(layer)),
        discretization_(ghosts_.discretization()),
        all_(point_data(input, discretization_)),
        own_(ghosts_.layer() ? std::make_unique<const OneStepProblem<dim>>(
                                   point_data(input, discretization))
                             : nullptr),
        mesh_(discretization_, ghosts_.cells()),
        hanging_(discretization_, mesh_, ghosts_.layer()),
        forces_(make_cell_forces(discretization_, mesh_,
                                 FrontViscosity(discretization_,
                                                input.front_viscosity(),
                                                ghosts_.cells()),
                                 ghosts_.cells())),
        faces_(discretization_, all_, hanging_),
        supports_(input, discretization_, mesh_),
        points_(discretization_, mesh_, all_),
        check_(input, [this](const std::size_t i) {
          return name_of_point<dim>(input_, discretization_.origins(),
                                    discretization_.points().position, i);
        })
  {
    ghosts_.set_mesh(mesh_, hanging_);
    if (hanging_.any())
      check_hanging(communicator_, discretization_, mesh_,
                    ghosts_.with(initial_state()), hanging_, supports_);
  }

  /** The motion and the points of @p state, with ghosts. */
  template <int dim>
  void Leapfrog<dim>::take(const State &state, std::vector<std::uint8_t> intact)
  {
    const auto &origins = discretization_.origins();
    for (std::size_t i = 0; i < intact.size(); ++i)
      if (!intact[i] && origins[i].kind != PointOrigin::Kind::motion &&
          mesh_.is_whole(mesh_.node_of_point(i)) &&
          !hanging_.hangs(mesh_.a_corner(i)))
        points_.add(unsigned(i), faces_.factors(unsigned(i)), state);
    groups_ = std::make_unique<CornerGroups<dim>>(mesh_, intact);
    faces_.start(std::move(intact));
    groups_->gather(state.displacement, groups_->displacement);
    groups_->gather(state.velocity, groups_->velocity);
    if (hanging_.any()) {
      hanging_.tie(*groups_);
      hanging_.follow(*groups_);
    }
    supports_.find(*groups_);
    hanging_.set_forces(*forces_, *groups_);
    front_ = forces_->front().finish(communicator_);
    if (discretization_.loads().any())
      set_loads(state.time);
  }

  template <int dim>
  State Leapfrog<dim>::start_from(const State &given)
  {
    State state = ghosts_.with(given);
    auto intact = joined_points(discretization_, state);
    for (std::size_t i = 0; i < intact.size(); ++i)
      if (intact[i])
        state.kind[i] = PointKind::bonded;
    take(state, std::move(intact));
    state.bond_traction.assign(state.jump.size(), 0.);
    show_at(state, {});
    const auto &g = *groups_;
    state.energy.kinetic = kinetic_energy();
    state.energy.elastic = -ghosts_.dot(g, g.force, g.displacement) / 2.;
    state.energy.cohesive = points_.initial_energy(communicator_);
    begin_balance(state);
    return ghosts_.without(std::move(state));
  }

  /** v.M v/2. Collective. */
  template <int dim>
  double Leapfrog<dim>::kinetic_energy()
  {
    const auto &g = *groups_;
    terms_.resize(g.velocity.size());
    for (std::size_t k = 0; k < terms_.size(); ++k)
      terms_[k] = g.mass[k / dim] * g.velocity[k] * g.velocity[k] / 2.;
    return ghosts_.sum(g, terms_);
  }

  /** Of the groups, before they move; all sums at once. Collective. */
  template <int dim>
  void Leapfrog<dim>::set_energies(const double kick, const double h,
                                   const double last, Energies &energies)
  {
    const auto &g = *groups_;
    const std::size_t n = g.force.size();
    const bool loaded = !loads_.of_groups.empty(), changed = h != last;
    const std::size_t n_rows = 3 + (loaded ? 2 : 0) + (changed ? 1 : 0);
    terms_.resize(n_rows * n);
    double *const rows = terms_.data();
    for (std::size_t i = 0, k = 0; i < g.size(); ++i)
      for (unsigned int c = 0; c < dim; ++c, ++k) {
        const double v = g.velocity[k], f = g.force[k];
        rows[k] = g.mass[i] * v * v / 2.;
        rows[n + k] = f * v;
        rows[2 * n + k] = f * g.displacement[k];
      }
    for (std::size_t k = 0; loaded && k < n; ++k) {
      rows[3 * n + k] = loads_.of_groups[k] * g.velocity[k];
      rows[4 * n + k] = loads_.of_groups[k] * old_velocity_[k];
    }
    for (std::size_t k = 0; changed && k < n; ++k)
      rows[(n_rows - 1) * n + k] = g.force[k] * old_velocity_[k];
    const auto sums = ghosts_.sums(g, terms_, n_rows);
    energies.kinetic = sums[0];
    energies.power = sums[1];
    energies.stored = -sums[2] / 2.;
    if (loaded)
      energies.work = kick / 2. * (sums[3] + sums[4]);
    if (changed)
      energies.numerical = -(last - h) / 4. * (sums[1] - sums.back());
  }

  template <int dim>
  void Leapfrog<dim>::resume_from(const State &given)
  {
    const State state = ghosts_.with(given);
    const auto &origins = discretization_.origins();
    std::vector<std::uint8_t> intact(origins.size());
    for (std::size_t i = 0; i < origins.size(); ++i)
      intact[i] =
          is_interface(origins[i]) && state.kind[i] == PointKind::bonded;
    take(state, std::move(intact));
  }

  /** Loads at @p time by corner and by group. */
  template <int dim>
  void Leapfrog<dim>::set_loads(const double time)
  {
    loads_.time = time;
    loads_.of_corners.assign(mesh_.n_corners() * dim, 0.);
    discretization_.add_loads(time, loads_.of_corners);
    loads_.of_groups.assign(groups_->force.size(), 0.);
    for (std::size_t i = 0; i < mesh_.n_corners(); ++i)
      for (unsigned int c = 0; c < dim; ++c)
        loads_.of_groups[groups_->of(i) * dim + c] +=
            loads_.of_corners[i * dim + c];
    hanging_.collect(*groups_, loads_.of_groups, loads_.shares);
  }

  /** Forces and loads on the groups of a node that has split. */
  template <int dim>
  void Leapfrog<dim>::gather(const std::size_t node)
  {
    auto &g = *groups_;
    loads_.of_groups.resize(loads_.of_corners.empty() ? 0 : g.force.size());
    for (const unsigned int corner : mesh_.corners_of_node(node))
      for (unsigned int c = 0; c < dim; ++c) {
        g.force[g.of(corner) * dim + c] = 0.;
        if (!loads_.of_groups.empty())
          loads_.of_groups[g.of(corner) * dim + c] = 0.;
      }
    for (const unsigned int corner : mesh_.corners_of_node(node)) {
      const auto force = forces_->corner_force(corner, g);
      for (unsigned int c = 0; c < dim; ++c) {
        g.force[g.of(corner) * dim + c] += force[c];
        if (!loads_.of_groups.empty())
          loads_.of_groups[g.of(corner) * dim + c] +=
              loads_.of_corners[corner * dim + c];
      }
    }
    hanging_.add_shares(node, g, g.shares, g.force);
    hanging_.add_shares(node, g, loads_.shares, loads_.of_groups);
  }

  /**
   * Faces that have reached their strength let go: nodes fall apart where they
   * are cut. Returns the number of points that count here.
   */
  template <int dim>
  unsigned int Leapfrog<dim>::let_go()
  {
    const auto points = faces_.reached(*forces_, counters_.excess);
    bool cut_support = false;
    unsigned int n_released = 0;
    for (const unsigned int point : points) {
      const std::size_t node = mesh_.node_of_point(point);
      if (mesh_.is_whole(node))
        points_.release(point, faces_.factors(point));
      n_released += mesh_.counts(node);
    }
    for (const unsigned int point : points) {
      const std::size_t node = mesh_.node_of_point(point);
      if (!groups_->split(node, faces_.intact()))
        continue;
      gather(node);
      for (const unsigned int corner : mesh_.corners_of_node(node))
        cut_support |= groups_->of(corner) < supports_.mask().size() &&
                       supports_.mask()[groups_->of(corner)] != 0;
    }
    if (cut_support)
      supports_.find(*groups_);
    supports_.resize(groups_->size());
    return n_released;
  }

  /** Without points: v- + k (f + F)/m, or what is prescribed. */
  template <int dim>
  void Leapfrog<dim>::move_freely(const double kick, const double time,
                                  const double h)
  {
    auto &g = *groups_;
    old_velocity_.swap(g.velocity);
    const std::size_t n = g.force.size();
    g.velocity.resize(n);
    for (std::size_t i = 0; i < g.size(); ++i) {
      // hanging nodes have no mass: they follow others
      const double share = g.mass[i] > 0. ? kick / g.mass[i] : 0.;
      for (unsigned int c = 0; c < dim; ++c)
        g.velocity[i * dim + c] =
            old_velocity_[i * dim + c] + share * g.force[i * dim + c];
    }
    if (!loads_.of_groups.empty())
      for (std::size_t i = 0; i < g.size(); ++i)
        for (unsigned int c = 0; g.mass[i] > 0. && c < dim; ++c)
          g.velocity[i * dim + c] +=
              kick / g.mass[i] * loads_.of_groups[i * dim + c];
    supports_.set_velocities(time, h, kick, g.force, loads_.of_groups, g);
  }

  /** What all ranks have done at the nodes. Collective. */
  template <int dim>
  void Leapfrog<dim>::count(const typename LeapfrogPoints<dim>::Outcome &mine,
                            StepReport &report)
  {
    const double here[6] = {double(mine.problems),   double(mine.sweeps),
                            double(mine.newton),     double(mine.loose),
                            double(report.released), double(!mine.converged)};
    const auto all = communicator_.sums(here, 6, 1);
    counters_.problems += std::uint64_t(all[0]);
    counters_.sweeps += std::uint64_t(all[1]);
    counters_.newton += std::uint64_t(all[2]);
    counters_.loose += std::uint64_t(all[3]);
    counters_.released += std::uint64_t(all[4]);
    report.solver.sweeps = unsigned(all[1]);
    report.solver.newton = unsigned(all[2]);
    report.released = unsigned(all[4]);
    report.solver.converged = all[5] == 0.;
    report.solver.residual = communicator_.max(mine.residual);
  }

  template <int dim>
  StepReport Leapfrog<dim>::advance(const State &old, const double h,
                                    State &next, const unsigned int)
  {
    const Stopwatch watch(counters_.seconds);
    StepReport report;
    const double last = old.last_step, kick = (h + last) / 2.;
    auto &g = *groups_;
    {
      const Charge charge(Cost::laws);
      report.released = let_go();
    }
    {
      const Charge charge(Cost::free_motion);
      if (discretization_.loads().depend_on_time() && old.time != loads_.time)
        set_loads(old.time);
      move_freely(kick, old.time, h);
    }
    typename LeapfrogPoints<dim>::Outcome outcome;
    {
      const Charge charge(Cost::solver);
      outcome =
          points_.solve(h, last, supports_.mask(), input_.solver.tolerance, g);
    }
    ghosts_.start(g);
    count(outcome, report);
    ghosts_.finish(g);
    if (!report.solver.converged) {
      old_velocity_.swap(g.velocity);
      check_.check_solution(h, old.time, report.solver, outcome.worst);
    }
    const Charge charge(Cost::energy_balance);
    Energies energies;
    set_energies(kick, h, last, energies);
    std::fill(supports_.rows().begin(), supports_.rows().end(), 0.);
    points_.add_impulses(supports_.row_of_group(), g, supports_.rows());
    energies.work += supports_.work(communicator_, kick, old_velocity_, g);
    {
      const Charge moving(Cost::update);
      old_displacement_.swap(g.displacement);
      g.displacement.resize(g.force.size());
      for (std::size_t k = 0; k < g.force.size(); ++k)
        g.displacement[k] = old_displacement_[k] + h * g.velocity[k];
      hanging_.follow(g);
      forces_->front().begin_step(h, kick);
      hanging_.set_forces(*forces_, *groups_);
    }
    const auto front = forces_->front().finish(communicator_);
    energies.numerical += (last - h) / 4. * (front_.after - front.before);
    energies.stored -= front_.stored / 2.;
    energies.power += front.before;
    // the part of the kinetic energy that the viscosity holds
    energies.kinetic -= h / 4. * front.after;
    energies.numerical += (kick - last) / 4. * front_.after;
    energies.viscous = front.taken;
    energies.power_after = ghosts_.dot(g, g.force, g.velocity) + front.after;
    front_ = front;
    try {
      book(old, h, energies, next, report);
    } catch (const StepRejected &rejected) {
      // the state before it is what the run can still show
      old_displacement_.swap(g.displacement);
      old_velocity_.swap(g.velocity);
      throw StepRejected(rejected.what(), StepRejected::Cure::none);
    }
    report.separates = communicator_.any(points_.accept());
    return report;
  }

  template <int dim>
  void Leapfrog<dim>::book(const State &old, const double h,
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
    energy.cohesive += balance.stored;
    energy.damage += balance.damage;
    energy.friction += balance.friction;
    energy.impact += balance.impact;
    energy.viscous += balance.viscous + bodies.viscous;
    energy.numerical += balance.numerical + bodies.numerical;
    energy.work += bodies.work;
    next.broken_area = old.broken_area + balance.broken;
    next.positive_friction_work =
        old.positive_friction_work + balance.positive_friction;
    next.initial_energy = old.initial_energy;
    next.penetration = std::max(old.penetration, balance.penetration);
    next.penetration_excess =
        std::max(old.penetration_excess,
                 balance.penetration - 1e-12 * discretization_.extent());
    next.rigid_drift = old.rigid_drift;
    next.viscous_traction = old.viscous_traction;
    next.pressure_work = old.pressure_work;
    report.active = balance.active;
    report.beyond_unique = balance.beyond_unique;
    report.changes = balance.changes;
    report.changes.taken[std::size_t(WatchedLine::scheme)] =
        energy.numerical - old.energy.numerical;
    report.changes.taken[std::size_t(WatchedLine::viscous)] =
        energy.viscous - old.energy.viscous;
    close_balance(old, next, report);
    const double scale = 4. * std::abs(energy.kinetic);
    const TakenStep step{old, next, h, scale, 0};
    check_.check_balance(step, report);
    check_.watch_energy(step, report);
  }

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

  template class Leapfrog<2>;
  template class Leapfrog<3>;
} // namespace nsfd
