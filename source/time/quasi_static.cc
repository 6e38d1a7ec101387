#include "nsfd/time/quasi_static.h"

#include "loose_motion.h"
#include "relaxation.h"
#include "static_ledger.h"

#include "nsfd/base/accelerated_rounds.h"
#include "nsfd/base/archive.h"
#include "nsfd/base/stopwatch.h"
#include "nsfd/mesh/node_coordinates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    // The longest and the shortest pseudo-time step, in crossings of a cell.
    // Above, (h/crossing)^2 times round-off would be seen in the jumps.
    constexpr double longest = 300., shortest = 0.05;
    constexpr unsigned int most_rounds = 200, accelerated = 12;

    /**
     * Ten crossings of all bodies: then masses hold against their slowest
     * vibration with less than a hundredth of its stiffness.
     */
    template <int dim>
    double first_step(const SceneInput &input,
                      const Discretization<dim> &discretization)
    {
      double speed = 0.;
      for (unsigned int m = 0; m < input.materials.size(); ++m)
        if (!input.materials[m].rigid)
          speed = std::max(speed, discretization.pressure_wave_speed(m));
      const double crossing = discretization.crossing_time();
      return std::clamp(10. * discretization.extent() / speed, 30. * crossing,
                        100. * crossing);
    }
  } // namespace

  template <int dim>
  QuasiStatic<dim>::QuasiStatic(const SceneInput &input,
                                const Communicator &communicator,
                                const Discretization<dim> &discretization)
      : input_(input),
        scene_(std::make_unique<const SceneInput>(static_scene(input))),
        communicator_(communicator), discretization_(discretization),
        crossing_(discretization.crossing_time()),
        h_(first_step(input, discretization))
  {
    const auto &solver = input.solver;
    dynamics_ = solver.path == "element-wise"
                    ? make_elementwise_dynamics<dim>(communicator,
                                                     discretization.bodies(),
                                                     discretization.points())
                    : make_sparse_dynamics<dim>(
                          communicator, discretization.bodies(),
                          discretization.points(),
                          solver.linear_solver,
                          node_coordinates(discretization));
    dynamics_->reinit(h_, 1.);
    solver_ = SolverRegistry<dim>::instance().create(
        solver.method == "auto" ? "dual newton" : solver.method);
    relaxation_ = std::make_unique<Relaxation<dim>>(*scene_, discretization,
                                                    *dynamics_, *solver_);
    ledger_ = std::make_unique<StaticLedger<dim>>(*scene_, discretization,
                                                  *dynamics_);
  }

  template <int dim>
  QuasiStatic<dim>::~QuasiStatic() = default;

  template <int dim>
  const std::vector<double> &QuasiStatic<dim>::reactions() const
  {
    return ledger_->reactions();
  }

  template <int dim>
  void QuasiStatic<dim>::remember(Archive &archive)
  {
    const Archive::Part part(archive, "equilibria");
    relaxation_->remember(archive);
    dynamics_->remember(archive);
    solver_->remember(archive);
  }

  template <int dim>
  const typename MoreauJean<dim>::Counters &
  QuasiStatic<dim>::solver_counters() const
  {
    return relaxation_->counters();
  }

  template <int dim>
  const typename MoreauJean<dim>::Timings &QuasiStatic<dim>::timings() const
  {
    return relaxation_->timings();
  }

  template <int dim>
  State QuasiStatic<dim>::start(const State &given)
  {
    State state = given;
    StepReport report;
    find(given, 0., state, report);
    ledger_->book(*relaxation_, std::vector<double>(given.velocity.size(), 0.),
                  given, state, report);
    const EnergyLines found = state.energy;
    state.energy = {};
    state.energy.elastic = found.elastic;
    state.energy.cohesive = found.cohesive;
    state.initial_energy = found.elastic + found.cohesive;
    state.largest_energy = state.initial_energy;
    state.pressure_work = state.positive_friction_work = 0.;
    state.step = 0;
    state.time = 0.;
    return state;
  }

  template <int dim>
  EquilibriumReport QuasiStatic<dim>::advance(const State &old,
                                              const double time, State &next)
  {
    EquilibriumReport report;
    std::vector<double> forces_old(old.velocity.size(), 0.);
    if (discretization_.has_loads())
      discretization_.add_loads(old.time, forces_old);
    find(old, time, next, report.step);
    report.stable = relaxation_->softening() < 1.;
    const EnergyLeft left =
        ledger_->book(*relaxation_, forces_old, old, next, report.step);
    report.left_over = left.energy;
    report.jumps = !report.stable || left.energy > jump_share * left.turnover;
    if (report.jumps) {
      // named by the last rank that has it
      const bool mine = left.worst == communicator_.max(left.worst);
      const int rank =
          int(communicator_.max(mine ? double(communicator_.rank()) : -1.));
      report.place = relaxation_->face(left.worst_point);
      int length = int(report.place.size());
      MPI_Bcast(&length, 1, MPI_INT, rank, communicator_.mpi());
      report.place.resize(std::size_t(length));
      MPI_Bcast(report.place.data(), length, MPI_CHAR, rank,
                communicator_.mpi());
    }
    return report;
  }

  /**
   * Rounds with KINSOL near the equilibrium, where the map is smooth. False,
   * with @p q as it was, if they have not come closer.
   */
  template <int dim>
  bool QuasiStatic<dim>::accelerate(std::vector<double> &q, StepReport &report)
  {
    const double start = relaxation_->imbalance();
    std::vector<double> mixed = q, best = q;
    double smallest = start;
    accelerated_rounds(communicator_, 5, accelerated, mixed,
                       [&](std::vector<double> &x) {
                         const bool more = round(x, report);
                         if (solved_ && relaxation_->imbalance() < smallest) {
                           smallest = relaxation_->imbalance();
                           best = x;
                         }
                         return more && relaxation_->imbalance() < 10. * start;
                       });
    q = best;
    solved_ = true;
    return smallest < start;
  }

  /** One long step. False if it ends the pass: in equilibrium, or unsolved. */
  template <int dim>
  bool QuasiStatic<dim>::round(std::vector<double> &q, StepReport &report)
  {
    // round-off of floating cells is seen in the jumps by (h/crossing)^2
    const double ratio = h_ / crossing_,
                 tolerance = std::max(0.1 * input_.statics->tolerance,
                                      1e-15 * ratio * ratio);
    ++counters_.rounds;
    const SolverReport solve = relaxation_->relax(q, h_, tolerance);
    report.solver.add_work(solve);
    solved_ = solve.converged;
    report.solver.residual = relaxation_->imbalance();
    report.solver.converged =
        solved_ && relaxation_->imbalance() <= input_.statics->tolerance;
    return solved_ && !report.solver.converged;
  }

  template <int dim>
  void QuasiStatic<dim>::refuse_loose_motion(const State &old,
                                             const double time, const double h)
  {
    const std::string loose = loose_motion(discretization_, communicator_, old,
                                           relaxation_->residual());
    if (loose.empty())
      return;
    h_ = h;
    throw StepRejected(
        fmt::format("no equilibrium at t = {:.6g}: the loads are not balanced, "
                    "and nothing holds {}",
                    time, loose));
  }

  template <int dim>
  void QuasiStatic<dim>::find(const State &old, const double time, State &next,
                              StepReport &report)
  {
    relaxation_->begin(old, time, time - old.time);
    std::vector<double> q = old.displacement;
    const double h = h_;
    double last = std::numeric_limits<double>::infinity(), near = 1e-3;
    bool &converged = report.solver.converged;
    for (unsigned int n = 0; n < most_rounds && !converged; ++n) {
      round(q, report);
      if (converged)
        break;
      if (!solved_) { // several solutions: closer to the last iterate
        if (h_ <= shortest * crossing_)
          break;
        h_ = std::max(h_ / 4., shortest * crossing_);
        last = std::numeric_limits<double>::infinity();
        ++counters_.step_changes;
        continue;
      }
      const double ratio = relaxation_->imbalance() / last;
      last = relaxation_->imbalance();
      if (h_ < h) {
        h_ = std::min(2. * h_, h);
        last = std::numeric_limits<double>::infinity();
        continue;
      }
      // what only masses resist stays as it is
      if (std::abs(ratio - 1.) < 1e-3)
        refuse_loose_motion(old, time, h);
      if (ratio > 0.1 && last < near) {
        if (!accelerate(q, report))
          near = 0.1 * last;
        last = relaxation_->imbalance();
      } else if (ratio > 0.5 && h_ < longest * crossing_) {
        h_ = std::min(4. * h_, longest * crossing_);
        last = std::numeric_limits<double>::infinity();
        ++counters_.step_changes;
      } else if (ratio > 0.5 && n > most_rounds / 4)
        near = std::numeric_limits<double>::infinity();
    }
    h_ = h;
    if (!converged) {
      refuse_loose_motion(old, time, h);
      throw StepRejected(fmt::format(
          "no equilibrium was found at t = {:.6g}: {:.2e} of the forces are "
          "left over; worst face {}",
          time, relaxation_->imbalance(), relaxation_->worst_face()));
    }
    ++counters_.equilibria;
    next.step = old.step + 1;
    next.time = time;
    next.last_step = 0.;
    next.displacement = q;
    next.velocity.assign(q.size(), 0.);
    next.relative_velocity.assign(old.jump.size(), 0.);
    next.point_force = relaxation_->point_force();
    next.pressure = relaxation_->pressure();
    next.impulse.assign(old.jump.size(), 0.);
    next.viscous_traction = old.viscous_traction;
    std::vector<double> change(q.size());
    for (std::size_t k = 0; k < q.size(); ++k)
      change[k] = q[k] - old.displacement[k];
    next.jump.resize(old.jump.size());
    dynamics_->relative_velocity(change.data(), next.jump.data());
    for (std::size_t k = 0; k < next.jump.size(); ++k)
      next.jump[k] += old.jump[k];
  }

  template class QuasiStatic<2>;
  template class QuasiStatic<3>;
} // namespace nsfd
