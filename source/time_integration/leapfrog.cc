#include "leapfrog.h"

#include "joined_start.h"
#include "point_name.h"
#include "step_data.h"

#include "core/cost.h"
#include "core/stopwatch.h"
#include "joined/rigid_clusters.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace nsfd
{
  template <int dim>
  Leapfrog<dim>::Leapfrog(const SceneInput &input,
                          const Discretization<dim> &discretization,
                          const Communicator &communicator,
                          std::unique_ptr<const GhostLayer<dim>> layer)
      : input_(input), ghosts_(communicator, discretization, std::move(layer)),
        communicator_(ghosts_.communicator()),
        discretization_(ghosts_.discretization()),
        all_(point_constants(input, discretization_)),
        own_(ghosts_.layer() ? std::make_unique<const OneStepProblem<dim>>(
                                   point_constants(input, discretization))
                             : nullptr),
        mesh_(discretization_, ghosts_.cells()),
        hanging_(discretization_, mesh_,
                 ghosts_.cells() ? ghosts_.layer() : nullptr),
        forces_(make_cell_forces(discretization_, mesh_,
                                 FrontViscosity(discretization_,
                                                input.front_viscosity(),
                                                ghosts_.cells()),
                                 ghosts_.cells(), ghosts_.divided())),
        faces_(discretization_, all_, hanging_),
        supports_(input, discretization_, mesh_),
        points_(discretization_, mesh_, all_),
        loads_(input, discretization_, mesh_, hanging_),
        check_(input, [this](const std::size_t i) {
          return name_of_point<dim>(input_, discretization_.origins(),
                                    discretization_.points().position, i);
        })
  {
    ghosts_.set_mesh(mesh_, hanging_);
    if (const auto *absorbing = loads_.absorbing())
      absorbing->check(communicator_);
    if (auto *finite = dynamic_cast<NonlinearForces<dim> *>(forces_.get()))
      large_ = std::make_unique<LeapfrogLarge<dim>>(
          input, discretization_, mesh_, all_, communicator_, *finite);
    if (!hanging_.any() && !input.has_rigid_bodies())
      return;
    State state = ghosts_.with(initial_state());
    if (hanging_.any())
      check_hanging(communicator_, discretization_, mesh_, state, hanging_,
                    supports_);
    if (!input.has_rigid_bodies())
      return;
    const auto intact = joined_points(discretization_, state);
    CornerGroups<dim> groups(mesh_, intact);
    groups.gather(state.displacement, groups.displacement);
    RigidGroups<dim> rigid(discretization_, mesh_, communicator_,
                           ghosts_.cells(),
                           rigid_clusters(discretization_, mesh_, communicator_,
                                          ghosts_.cells(), intact));
    if (input.large_motion)
      rigid.set_places(state);
    rigid.find(groups, supports_);
    rigid.check(input.time.end, groups, supports_);
  }

  template <int dim>
  void Leapfrog<dim>::find_supports()
  {
    if (rigid_)
      rigid_->find(*groups_, supports_);
    else
      supports_.find(*groups_, {});
  }

  /** Of the groups, before they move; all sums at once. Collective. */
  template <int dim>
  void Leapfrog<dim>::set_energies(const double kick, const double h,
                                   const double last, Energies &energies)
  {
    const auto &g = *groups_;
    const std::size_t n = g.force.size();
    // also in the first step, and where it may become another one
    const bool other_length = h != last || large_;
    std::vector<const std::vector<double> *> loads; // given and in cracks
    if (!loads_.of_groups().empty())
      loads.push_back(&loads_.of_groups());
    if (loads_.cracks())
      loads.push_back(&loads_.cracks()->of_groups());
    const auto *absorbing = loads_.absorbing();
    const std::size_t n_rows =
        3 + 2 * loads.size() + (absorbing ? 1 : 0) + (other_length ? 1 : 0);
    terms_.resize(n_rows * n);
    double *const rows = terms_.data();
    for (std::size_t i = 0, k = 0; i < g.size(); ++i)
      for (unsigned int c = 0; c < dim; ++c, ++k) {
        const double v = g.velocity[k], f = g.force[k];
        rows[k] = g.mass[i] * v * v / 2.;
        rows[n + k] = f * v;
        rows[2 * n + k] = f * g.displacement[k];
      }
    double *row = rows + 3 * n;
    const std::vector<double> *const both[2] = {&g.velocity, &before_.velocity};
    for (const auto *load : loads)
      for (const auto *velocity : both) {
        for (std::size_t k = 0; k < n; ++k)
          row[k] = (*load)[k] * (*velocity)[k];
        row += n;
      }
    if (absorbing) {
      absorbing->put_energy(kick, before_.velocity, g, row);
      row += n;
    }
    for (std::size_t k = 0; other_length && k < n; ++k)
      row[k] = g.force[k] * before_.velocity[k];
    const double of_bodies = rigid_ ? rigid_->kinetic_energy(g, terms_) : 0.;
    const auto sums = ghosts_.sums(g, terms_, n_rows);
    energies.kinetic = sums[0] + of_bodies;
    energies.power = sums[1];
    energies.stored = -sums[2] / 2.;
    if (!loads_.of_groups().empty())
      energies.work = kick / 2. * (sums[3] + sums[4]);
    if (loads_.cracks()) {
      const std::size_t at = 1 + 2 * loads.size();
      energies.pressure_work = kick / 2. * (sums[at] + sums[at + 1]);
    }
    if (absorbing)
      energies.absorbed = sums[3 + 2 * loads.size()];
    if (other_length) {
      energies.power_before = sums.back();
      energies.numerical = (h - last) / 4. * (sums[1] - sums.back());
    }
    if (large_)
      large_->take_energies(h, last, before_.velocity, g, energies);
  }

  /** Forces and loads on the groups of a node that has split. */
  template <int dim>
  void Leapfrog<dim>::gather(const std::size_t node)
  {
    auto &g = *groups_;
    for (const unsigned int corner : mesh_.corners_of_node(node))
      for (unsigned int c = 0; c < dim; ++c)
        g.force[g.of(corner) * dim + c] = 0.;
    loads_.gather(node, g);
    if (auto *viscous = forces_->viscous())
      viscous->gather(node, g, hanging_);
    for (const unsigned int corner : mesh_.corners_of_node(node)) {
      const auto force = forces_->corner_force(corner, g);
      for (unsigned int c = 0; c < dim; ++c)
        g.force[g.of(corner) * dim + c] += force[c];
    }
    hanging_.add_shares(node, g, g.shares, g.force);
  }

  /**
   * Faces that have reached their strength are released: nodes fall apart where
   * they are cut. Returns the number of points that count here.
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
    // rigid bodies have turned
    if (rigid_ ? input_.large_motion || communicator_.any(cut_support)
               : cut_support)
      find_supports();
    supports_.resize(groups_->size());
    return n_released;
  }

  /** Without points: v- + k (f + F)/m, or what is prescribed. */
  template <int dim>
  void Leapfrog<dim>::move_freely(const double kick, const double time,
                                  const double h)
  {
    auto &g = *groups_;
    before_.velocity.swap(g.velocity);
    const std::size_t n = g.force.size();
    g.velocity.resize(n);
    for (std::size_t i = 0; i < g.size(); ++i) {
      // hanging nodes have no mass: they follow others
      const double share = g.mass[i] > 0. ? kick / g.mass[i] : 0.;
      for (unsigned int c = 0; c < dim; ++c)
        g.velocity[i * dim + c] =
            before_.velocity[i * dim + c] + share * g.force[i * dim + c];
    }
    const std::vector<double> &given =
        loads_.sum(time, forces_->viscous(), points_.chains(), g);
    if (!given.empty())
      for (std::size_t i = 0; i < g.size(); ++i)
        for (unsigned int c = 0; g.mass[i] > 0. && c < dim; ++c)
          g.velocity[i * dim + c] += kick / g.mass[i] * given[i * dim + c];
    supports_.set_velocities(time, h, kick, g.force, given, g);
    if (auto *absorbing = loads_.absorbing()) {
      absorbing->set_drag(kick, g);
      absorbing->brake(kick, before_.velocity, supports_.mask(), g);
    }
    if (rigid_)
      rigid_->set_velocities(time, h, kick, g.force, given, supports_, g);
  }

  template <int dim>
  void Leapfrog<dim>::Counters::add(
      const Communicator &communicator,
      const typename LeapfrogPoints<dim>::Outcome &mine, StepReport &report)
  {
    const double here[7] = {double(mine.problems),   double(mine.sweeps),
                            double(mine.newton),     double(mine.inexact),
                            double(report.released), double(!mine.converged),
                            double(mine.held)};
    const auto all = communicator.sums(here, 7, 1);
    problems += std::uint64_t(all[0]);
    sweeps += std::uint64_t(all[1]);
    newton += std::uint64_t(all[2]);
    inexact += std::uint64_t(all[3]);
    released += std::uint64_t(all[4]);
    held += std::uint64_t(all[6]);
    excess = std::max(excess, mine.excess);
    report.solver.sweeps = unsigned(all[1]);
    report.solver.newton = unsigned(all[2]);
    report.released = unsigned(all[4]);
    report.solver.converged = all[5] == 0.;
    report.beyond_unique = all[6] > 0.;
    report.solver.residual = communicator.max(mine.residual);
  }

  template <int dim>
  StepReport Leapfrog<dim>::advance(const State &old, const double h,
                                    State &next, const unsigned int)
  {
    const Stopwatch watch(counters_.seconds);
    StepReport report;
    const double last = old.last_step, kick = (h + last) / 2.;
    if (last > 0. && h != last && !large_)
      throw std::logic_error("explicit steps have one length");
    auto &g = *groups_;
    const auto go_back = [&] {
      before_.velocity.swap(g.velocity);
      if (rigid_)
        rigid_->go_back();
    };
    // steps of small motions have one length
    const auto cure =
        large_ ? StepRejected::Cure::shorter_step : StepRejected::Cure::none;
    // with the displacements before it, too
    const auto forces_before = [&] {
      before_.displacement.swap(g.displacement);
      go_back();
      if (large_)
        large_->go_back(forces_->front());
      forces_->front().holds = true; // what it has is not found again
      hanging_.set_forces(*forces_, g);
      forces_->front().holds = false;
    };
    {
      const Charge charge(Cost::laws);
      if (has_warm_faces(input_)) {
        const auto temperatures = ghosts_.with_points(old.heat.at_faces);
        faces_.warm(temperatures);
        points_.warm(temperatures, [this](const unsigned int point) {
          return faces_.factors(point);
        });
      }
      report.released = let_go();
    }
    Energies energies;
    if (large_)
      large_->begin(old.time, h, supports_.mask(), rigid_.get(), g, points_,
                    energies);
    {
      const Charge charge(Cost::free_motion);
      loads_.move_to(old.time, old.clock, g);
      supports_.set_clock(old.clock);
      move_freely(kick, old.time, h);
    }
    typename LeapfrogPoints<dim>::Outcome outcome;
    {
      const Charge charge(Cost::solver);
      const double tolerance = input_.solver.tolerance;
      outcome = input_.large_motion
                    ? large_->solve(h, last, supports_.mask(), tolerance,
                                    rigid_.get(), points_, g)
                    : points_.solve(h, last, supports_.mask(), tolerance, g);
      if (rigid_ && !input_.large_motion)
        points_.solve_rigid(input_.solver.tolerance, communicator_, *rigid_, g,
                            outcome);
      if (outcome.impossible) {
        go_back();
        throw StepRejected(outcome.impossible, StepRejected::Cure::none);
      }
    }
    ghosts_.start(g);
    counters_.add(communicator_, outcome, report);
    ghosts_.finish(g);
    if (!report.solver.converged) {
      go_back();
      check_.check_solution(h, old.time, report.solver, outcome.worst, cure);
    }
    const Charge charge(Cost::energy_balance);
    set_energies(kick, h, last, energies);
    std::fill(supports_.rows().begin(), supports_.rows().end(), 0.);
    points_.add_impulses(supports_.row_of_group(), supports_.rows());
    if (const auto *absorbing = loads_.absorbing())
      absorbing->add_impulses(kick, before_.velocity, g,
                              supports_.row_of_group(), supports_.rows());
    if (large_)
      large_->add_impulses(supports_.row_of_group(), supports_.rows());
    energies.work += supports_.work(communicator_, kick, before_.velocity, g);
    if (rigid_)
      energies.work += rigid_->work(kick, supports_);
    {
      const Charge moving(Cost::update);
      before_.displacement.swap(g.displacement);
      g.displacement.resize(g.force.size());
      for (std::size_t k = 0; k < g.force.size(); ++k)
        g.displacement[k] = before_.displacement[k] + h * g.velocity[k];
      hanging_.follow(g);
      const auto refuse = [&](const StepRejected &rejected) {
        before_.displacement.swap(g.displacement);
        go_back();
        throw rejected;
      };
      if (rigid_ && input_.large_motion)
        if (const std::string body = rigid_->fly(h, g); !body.empty())
          refuse(StepRejected(
              fmt::format("in the step of {:.4g} s at t = {:.6g} s a rigid "
                          "body turns too far: {}",
                          h, old.time, body)));
      if (const auto missed = large_ ? large_->missed(g) : std::nullopt)
        refuse(*missed);
      forces_->front().begin_step(h, kick);
      if (large_)
        large_->begin_forces(h, forces_->front());
      hanging_.set_forces(*forces_, *groups_);
    }
    if (const std::string place = large_ ? large_->inverted() : "";
        !place.empty()) {
      forces_before();
      large_->ask_for_shorter_steps();
      throw StepRejected(fmt::format(
          "the cell at {} (before the motion) would be turned inside out in "
          "the step of {:.4g} s at t = {:.6g} s: smaller cells there, or a law "
          "by which they break, may help",
          place, h, old.time));
    }
    const auto front = forces_->front().finish(communicator_);
    energies.power_after = ghosts_.dot(g, g.force, g.velocity);
    if (large_) {
      large_->take_forces(old.step + 1, h, g, energies);
      if (large_->is_too_long(std::max(old.largest_energy, energies.kinetic))) {
        forces_before();
        large_->ask_for_shorter_steps();
        throw StepRejected(fmt::format(
            "in the step of {:.4g} s at t = {:.6g} s forces change so much "
            "that the bodies would get energy from nothing",
            h, old.time));
      }
      if (forces_->viscous())
        damp(h, last, energies);
    } else {
      energies.stored -= before_.front.stored / 2.;
      energies.power += front.before;
      // the part of the kinetic energy that the viscosity holds
      energies.kinetic -= h / 4. * front.after;
      energies.viscous = front.taken;
      if (forces_->viscous())
        damp(h, last, energies);
      energies.power_after += front.after;
    }
    before_.front = front;
    try {
      account(old, h, energies, next, report);
    } catch (const StepRejected &rejected) {
      // the state before it is what the run can still show
      forces_before();
      throw StepRejected(rejected.what(), cure);
    }
    report.separates = communicator_.any(points_.accept());
    if (large_)
      report.separates |= large_->accept(points_);
    return report;
  }

  template class Leapfrog<2>;
  template class Leapfrog<3>;
} // namespace nsfd
