#include "leapfrog.h"

#include "initial_state.h"
#include "joined_points.h"
#include "point_name.h"
#include "step_data.h"

#include "core/cost.h"
#include "core/stopwatch.h"
#include "discretization/loads.h"
#include "joined/rigid_clusters.h"
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
        forces_(make_cell_forces(discretization_, mesh_,
                                 FrontViscosity(discretization_,
                                                input.front_viscosity(),
                                                ghosts_.cells()),
                                 ghosts_.cells())),
        faces_(discretization_, all_), supports_(input, discretization_, mesh_),
        points_(discretization_, mesh_, all_),
        check_(input, [this](const std::size_t i) {
          return name_of_point<dim>(input_, discretization_.origins(),
                                    discretization_.points().position, i);
        })
  {
    ghosts_.set_mesh(mesh_);
    loads_.of_cracks =
        LeapfrogPressure<dim>::make(input, discretization_, mesh_);
    if (!has_rigid_cells(input))
      return;
    State state = ghosts_.with(initial_state());
    const auto intact = joined_points(discretization_, state);
    CornerGroups<dim> groups(mesh_, intact);
    groups.gather(state.displacement, groups.displacement);
    RigidGroups<dim> rigid(discretization_, mesh_, communicator,
                           ghosts_.cells(),
                           rigid_clusters(discretization_, mesh_, communicator,
                                          ghosts_.cells(), intact));
    rigid.find(groups, supports_);
    rigid.check(input.time.end, groups, supports_);
  }

  template <int dim>
  State Leapfrog<dim>::initial_state() const
  {
    State state = initial_motion(input_, discretization_);
    const auto &points = discretization_.points();
    state.jump.assign(points.n_points * dim, 0.);
    state.relative_velocity.assign(points.n_points * dim, 0.);
    for (std::size_t i = 0; i < points.n_points; ++i)
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
    set_points(input_, discretization_, all_, state);
    for (std::size_t i = 0; i < points.n_points; ++i)
      if (!state.two_sided[i]) // contact holds where it is
        state.released_overlap[i] = std::max(0., -state.jump[i * dim]);
    return ghosts_.without(std::move(state));
  }

  /** The motion and the points of @p state, with ghosts. */
  template <int dim>
  void Leapfrog<dim>::take(const State &state, std::vector<std::uint8_t> intact)
  {
    const auto &origins = discretization_.origins();
    for (std::size_t i = 0; i < intact.size(); ++i)
      if (!intact[i] && origins[i].kind != PointOrigin::Kind::motion &&
          mesh_.is_whole(mesh_.node_of_point(i)))
        points_.add(unsigned(i), faces_.factors(unsigned(i)), state);
    groups_ = std::make_unique<CornerGroups<dim>>(mesh_, intact);
    rigid_.reset();
    if (has_rigid_cells(input_))
      rigid_ = std::make_unique<RigidGroups<dim>>(
          discretization_, mesh_, communicator_, ghosts_.cells(),
          rigid_clusters(discretization_, mesh_, communicator_, ghosts_.cells(),
                         intact));
    faces_.start(std::move(intact));
    groups_->gather(state.displacement, groups_->displacement);
    groups_->gather(state.velocity, groups_->velocity);
    ghosts_.fetch_motion(*groups_);
    find_supports();
    forces_->set_forces(*groups_);
    if (auto *viscous = forces_->viscous())
      viscous->set(*groups_);
    front_ = forces_->front().finish(communicator_);
    if (discretization_.loads().any())
      set_loads(state.time);
  }

  template <int dim>
  State Leapfrog<dim>::start_from(const State &given)
  {
    State state = ghosts_.with(given);
    take(state, joined_points(discretization_, state));
    if (rigid_)
      rigid_->start(*groups_);
    state.bond_traction.assign(state.jump.size(), 0.);
    show_at(state, {});
    const auto &g = *groups_;
    state.energy.kinetic = kinetic_energy();
    state.energy.elastic = -ghosts_.dot(g, g.force, g.displacement) / 2.;
    state.energy.cohesive = points_.initial_energy(communicator_);
    begin_balance(state);
    return ghosts_.without(std::move(state));
  }

  template <int dim>
  void Leapfrog<dim>::find_supports()
  {
    if (rigid_)
      rigid_->find(*groups_, supports_);
    else
      supports_.find(*groups_, {});
  }

  /** v.M v/2. Collective. */
  template <int dim>
  double Leapfrog<dim>::kinetic_energy()
  {
    const auto &g = *groups_;
    terms_.resize(g.velocity.size());
    for (std::size_t k = 0; k < terms_.size(); ++k)
      terms_[k] = g.mass[k / dim] * g.velocity[k] * g.velocity[k] / 2.;
    const double of_bodies = rigid_ ? rigid_->kinetic_energy(g, terms_) : 0.;
    return ghosts_.sum(g, terms_) + of_bodies;
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
    if (auto *viscous = forces_->viscous())
      viscous->gather(node, g);
    for (const unsigned int corner : mesh_.corners_of_node(node)) {
      const auto force = forces_->corner_force(corner, g);
      for (unsigned int c = 0; c < dim; ++c) {
        g.force[g.of(corner) * dim + c] += force[c];
        if (!loads_.of_groups.empty())
          loads_.of_groups[g.of(corner) * dim + c] +=
              loads_.of_corners[corner * dim + c];
      }
    }
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
    if (rigid_ ? communicator_.any(cut_support) : cut_support)
      find_supports();
    supports_.resize(groups_->size());
    return n_released;
  }

  /** On groups: loads, of viscous materials and of fluid in cracks; or none. */
  template <int dim>
  const std::vector<double> &Leapfrog<dim>::given_forces(const double time)
  {
    const auto *viscous = forces_->viscous();
    auto *cracks = loads_.of_cracks.get();
    if (!viscous && !cracks)
      return loads_.of_groups;
    loads_.sum = loads_.of_groups;
    loads_.sum.resize(groups_->force.size(), 0.);
    const auto add = [this](const std::vector<double> &more) {
      for (std::size_t k = 0; k < more.size(); ++k)
        loads_.sum[k] += more[k];
    };
    if (viscous)
      add(viscous->of_groups());
    if (cracks) {
      cracks->set(time, points_.chains(), *groups_);
      add(cracks->of_groups());
    }
    return loads_.sum;
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
      const double share = kick / g.mass[i];
      for (unsigned int c = 0; c < dim; ++c)
        g.velocity[i * dim + c] =
            old_velocity_[i * dim + c] + share * g.force[i * dim + c];
    }
    const std::vector<double> &given = given_forces(time);
    if (!given.empty())
      for (std::size_t i = 0; i < g.size(); ++i)
        for (unsigned int c = 0; c < dim; ++c)
          g.velocity[i * dim + c] += kick / g.mass[i] * given[i * dim + c];
    supports_.set_velocities(time, h, kick, g.force, given, g);
    if (rigid_)
      rigid_->set_velocities(time, h, kick, g.force, given, supports_, g);
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
    const auto go_back = [&] {
      old_velocity_.swap(g.velocity);
      if (rigid_)
        rigid_->go_back();
    };
    {
      const Charge charge(Cost::laws);
      report.released = let_go();
    }
    double of_change = 0.;
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
      if (rigid_)
        points_.solve_rigid(input_.solver.tolerance, communicator_, *rigid_, g,
                            outcome);
      if (outcome.impossible) {
        go_back();
        throw StepRejected(outcome.impossible, StepRejected::Cure::none);
      }
    }
    ghosts_.start(g);
    count(outcome, report);
    ghosts_.finish(g);
    if (!report.solver.converged) {
      go_back();
      check_.check_solution(h, old.time, report.solver, outcome.worst);
    }
    const Charge charge(Cost::energy_balance);
    const auto &f = g.force;
    Energies energies;
    if (h != last)
      of_change =
          (last - h) / 4. *
          (ghosts_.dot(g, f, g.velocity) - ghosts_.dot(g, f, old_velocity_));
    energies.numerical = -of_change;
    energies.stored = -ghosts_.dot(g, f, g.displacement) / 2.;
    energies.power = ghosts_.dot(g, f, g.velocity);
    if (!loads_.of_groups.empty())
      energies.work = kick / 2. *
                      (ghosts_.dot(g, loads_.of_groups, g.velocity) +
                       ghosts_.dot(g, loads_.of_groups, old_velocity_));
    if (loads_.of_cracks)
      energies.pressure_work =
          kick / 2. *
          (ghosts_.dot(g, loads_.of_cracks->of_groups(), g.velocity) +
           ghosts_.dot(g, loads_.of_cracks->of_groups(), old_velocity_));
    std::fill(supports_.rows().begin(), supports_.rows().end(), 0.);
    points_.add_impulses(supports_.row_of_group(), g, supports_.rows());
    energies.work += supports_.work(communicator_, kick, old_velocity_, g);
    if (rigid_)
      energies.work += rigid_->work(kick, supports_);
    energies.kinetic = kinetic_energy();
    {
      const Charge moving(Cost::update);
      old_displacement_.swap(g.displacement);
      g.displacement.resize(f.size());
      for (std::size_t k = 0; k < f.size(); ++k)
        g.displacement[k] = old_displacement_[k] + h * g.velocity[k];
      forces_->front().begin_step(h, kick);
      forces_->set_forces(g);
    }
    const auto front = forces_->front().finish(communicator_);
    energies.numerical += (last - h) / 4. * (front_.after - front.before);
    energies.stored -= front_.stored / 2.;
    energies.power += front.before;
    // the part of the kinetic energy that the viscosity holds
    energies.kinetic -= h / 4. * front.after;
    energies.numerical += (kick - last) / 4. * front_.after;
    energies.viscous = front.taken;
    if (forces_->viscous())
      damp(h, last, energies);
    energies.power_after = ghosts_.dot(g, f, g.velocity) + front.after;
    front_ = front;
    try {
      book(old, h, energies, next, report);
    } catch (const StepRejected &rejected) {
      // the state before it is what the run can still show
      old_displacement_.swap(g.displacement);
      go_back();
      throw StepRejected(rejected.what(), StepRejected::Cure::none);
    }
    report.separates = communicator_.any(points_.accept());
    return report;
  }

  template class Leapfrog<2>;
  template class Leapfrog<3>;
} // namespace nsfd
