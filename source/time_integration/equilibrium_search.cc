#include "equilibrium_search.h"

#include "energy_watch.h"
#include "peak_rule.h"
#include "relaxation.h"
#include "rigid_body_modes.h"
#include "static_balance.h"

#include "core/accelerated_rounds.h"
#include "core/stopwatch.h"
#include "discretization/loads.h"
#include "nsfd/core/archive.h"
#include "state/point_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    // The longest and the shortest pseudo-time step, as Courant numbers.
    // Above, (h/crossing)^2 times round-off would be seen in the jumps. Of n
    // cells with common nodes it is divided by n: they float together.
    constexpr double longest = 300., shortest = 0.05, of_joined = 1e4;
    // over the first one, where a shorter step of the load is to be tried
    constexpr double shortest_hurried = 1. / 16.;
    constexpr unsigned int most_rounds = 200, accelerated = 12;
    // with springs in place of laws; and how often these are damaged further
    constexpr unsigned int most_held_rounds = 40, most_bits = 100;

    /**
     * Ten times the transit time of all bodies: then masses hold
     * against their slowest vibration with less than a hundredth of its
     * stiffness.
     */
    template <int dim>
    double first_step(const SceneInput &input,
                      const Discretization<dim> &discretization)
    {
      double speed = 0.;
      for (unsigned int m = 0; m < input.materials.size(); ++m)
        if (!input.materials[m].rigid)
          speed = std::max(speed, discretization.extremes(m).fastest);
      const double crossing = discretization.crossing_time();
      return std::clamp(10. * discretization.extent() / speed, 30. * crossing,
                        100. * crossing);
    }
  } // namespace

  template <int dim>
  EquilibriumSearch<dim>::EquilibriumSearch(
      const SceneInput &input, const Discretization<dim> &discretization,
      std::unique_ptr<DelassusOperator<dim>> delassus,
      std::unique_ptr<NonsmoothSolver<dim>> solver)
      : input_(input),
        scene_(std::make_unique<const SceneInput>(static_scene(input))),
        communicator_(delassus->communicator()),
        discretization_(discretization), delassus_(std::move(delassus)),
        solver_(std::move(solver)), crossing_(discretization.crossing_time()),
        h_(first_step(input, discretization)), first_h_(h_)
  {
    delassus_->reinit(h_, 1.);
    relaxation_ = std::make_unique<Relaxation<dim>>(
        *scene_, discretization, *delassus_, *solver_,
        dynamic_cast<JoinedDelassus<dim> *>(delassus_.get()));
    balance_ = std::make_unique<StaticBalance<dim>>(*scene_, discretization,
                                                    *delassus_);
  }

  template <int dim>
  EquilibriumSearch<dim>::~EquilibriumSearch() = default;

  template <int dim>
  const std::vector<double> &EquilibriumSearch<dim>::reactions() const
  {
    return balance_->reactions();
  }

  template <int dim>
  void EquilibriumSearch<dim>::serialize(Archive &archive)
  {
    const Archive::Part part(archive, "equilibria");
    relaxation_->balance().serialize(archive);
    delassus_->serialize(archive);
    solver_->serialize(archive);
  }

  template <int dim>
  const OneStepProblem<dim> &EquilibriumSearch<dim>::points() const
  {
    return relaxation_->points();
  }

  template <int dim>
  const StepCounters &EquilibriumSearch<dim>::solver_counters() const
  {
    return relaxation_->counters();
  }

  template <int dim>
  const StepTimings &EquilibriumSearch<dim>::timings() const
  {
    return relaxation_->timings();
  }

  template <int dim>
  State EquilibriumSearch<dim>::start(const State &given)
  {
    State state = given;
    StepReport report;
    start_ = 0.;
    find(given, 0., Way::near, state, report);
    balance_->account(*relaxation_,
                      std::vector<double>(given.velocity.size(), 0.), given,
                      state, report);
    const EnergyLines found = state.energy;
    state.energy = {};
    state.energy.elastic = found.elastic;
    state.energy.cohesive = found.cohesive;
    state.initial_energy = found.elastic + found.cohesive;
    state.largest_energy = state.initial_energy;
    state.pressure_work = state.positive_friction_work = 0.;
    state.step = 0;
    state.time = 0.;
    release_zeros(state);
    return state;
  }

  /** A load step from @p old, by steps as long as its bodies allow. */
  template <int dim>
  void EquilibriumSearch<dim>::begin(const State &old, const double time)
  {
    relaxation_->begin(old, time, time - start_);
    const auto bonds = relaxation_->bonds();
    if (!bonds)
      return;
    crossing_ = discretization_.crossing_time() *
                std::sqrt(bonds->cells_of_smallest_body());
    first_h_ = of_joined * crossing_;
  }

  /** Named by the last rank that has the largest @p value. */
  template <int dim>
  std::string EquilibriumSearch<dim>::face_of_all(const double value,
                                                  const std::size_t point) const
  {
    const bool mine = value == communicator_.max(value);
    const int rank =
        int(communicator_.max(mine ? double(communicator_.rank()) : -1.));
    std::string place = relaxation_->face(point);
    int length = int(place.size());
    MPI_Bcast(&length, 1, MPI_INT, rank, communicator_.mpi());
    place.resize(std::size_t(length));
    MPI_Bcast(place.data(), length, MPI_CHAR, rank, communicator_.mpi());
    return place;
  }

  namespace
  {
    /** Points have laws that damage, on any rank. */
    bool has_laws(const SceneInput &input)
    {
      return std::any_of(input.interfaces.begin(), input.interfaces.end(),
                         [](const InterfaceInput &one) { return one.law; });
    }
  } // namespace

  template <int dim>
  EquilibriumReport
  EquilibriumSearch<dim>::try_way(const State &old, const double time,
                                  const Way way, const bool path, State &next)
  {
    EquilibriumReport report;
    std::vector<double> forces_old(old.velocity.size(), 0.);
    if (discretization_.loads().any())
      discretization_.add_loads(start_, forces_old, old.clock);
    find(old, time, way, next, report.step);
    report.stable = relaxation_->softening() < 1.;
    const EnergyLeft left =
        balance_->account(*relaxation_, forces_old, old, next, report.step);
    report.released_energy = left.energy;
    report.above_mean = left.above_mean;
    report.round_off = energy_round_off * next.largest_energy;
    report.jumps =
        !report.stable ||
        std::abs(left.energy) > jump_share * left.turnover + report.round_off;
    const auto seen = relaxation_->laws().passages(next, path);
    report.peak_seen = -communicator_.max(-seen.least);
    report.starts_at_peak =
        communicator_.max(seen.largest) >= Passage::least_share;
    report.skips_peak = report.peak_seen < Passage::least_share;
    if (report.skips_peak)
      report.place = face_of_all(-seen.least, seen.point);
    else if (report.jumps)
      report.place = face_of_all(left.worst, left.worst_point);
    release_zeros(next);
    return report;
  }

  template <int dim>
  EquilibriumReport
  EquilibriumSearch<dim>::advance(const State &old, const double time,
                                  State &next, const bool may_be_shortened,
                                  const double delay)
  {
    start_ = old.time - delay;
    if (!has_laws(input_))
      return try_way(old, time, Way::near, false, next);

    // nothing damages: one equilibrium, and next to the last one
    hurried_ = may_be_shortened && relaxation_->bonds();
    begin(old, time);
    relaxation_->laws().hold();
    held_ = old.displacement;
    StepReport held;
    typename HeldLaws<dim>::Prediction ahead;
    ahead.damages = true;
    const bool predicted = settle(held_, most_held_rounds,
                                  input_.statics->tolerance, held, nullptr);
    if (predicted)
      ahead = relaxation_->laws().prediction();
    EquilibriumReport best;
    if (may_be_shortened && ahead.certain) {
      best.skips_peak = true;
      best.share = ahead.share;
      return best;
    }

    // what comes to its peak first is there; what follows is pulled there
    const bool at_peak = predicted && ahead.share == 1.;
    std::string failure;
    bool found = false;
    State best_next;
    std::vector<double> reactions;
    for (const Way way : {Way::held, Way::near, Way::damped}) {
      if (way == Way::held && ahead.damages)
        continue;
      // a shorter step is cheaper than the path of a motion, which is for what
      // none is short enough for
      if (way == Way::damped && found && may_be_shortened &&
          relaxation_->bonds())
        break;
      EquilibriumReport report;
      try {
        report = try_way(old, time, way, at_peak && way == Way::damped, next);
      } catch (const StepRejected &rejected) {
        failure = rejected.what();
        continue;
      }
      // other points follow in the jump from one that was at its peak
      if (!may_be_shortened && report.skips_peak && report.starts_at_peak) {
        report.skips_peak = false;
        report.jumps = true;
      }
      const auto merit = [](const EquilibriumReport &x) {
        return x.accepted() ? 3 : x.may_follow() ? 1 + x.stable : 0;
      };
      if (!found || merit(report) > merit(best)) {
        found = true;
        best = report;
        // or a jump downhill, where no shorter step is to show another way
        if (best.accepted() ||
            (!may_be_shortened && best.may_follow() && best.stable))
          return best;
        best_next = next;
        release_zeros(best_next);
        reactions = balance_->reactions();
      }
    }
    if (!found)
      throw StepRejected(failure);
    next = std::move(best_next);
    balance_->set_reactions(reactions);
    if (best.skips_peak)
      best.share = ahead.share;
    return best;
  }

  /**
   * Rounds with KINSOL near the equilibrium, where the map is smooth. False,
   * with @p q as it was, if they have not come closer.
   */
  template <int dim>
  bool EquilibriumSearch<dim>::accelerate(std::vector<double> &q,
                                          StepReport &report)
  {
    const double start = relaxation_->balance().imbalance();
    std::vector<double> mixed = q, best = q;
    double smallest = start;
    accelerated_rounds(
        communicator_, 5, accelerated, mixed, [&](std::vector<double> &x) {
          const bool more = round(x, report);
          if (solved_ && relaxation_->balance().imbalance() < smallest) {
            smallest = relaxation_->balance().imbalance();
            best = x;
          }
          return more && relaxation_->balance().imbalance() < 10. * start;
        });
    q = best;
    solved_ = true;
    return smallest < start;
  }

  /** One long step. False if it ends the pass: in equilibrium, or unsolved. */
  template <int dim>
  bool EquilibriumSearch<dim>::round(std::vector<double> &q, StepReport &report)
  {
    // round-off of floating cells is seen in the jumps by (h/crossing)^2
    const double ratio = std::min(h_ / crossing_, 100.),
                 tolerance = std::max(0.1 * goal_, 1e-15 * ratio * ratio);
    ++counters_.rounds;
    const SolverReport solve = relaxation_->relax(q, h_, tolerance);
    report.solver.add_work(solve);
    solved_ = solve.converged;
    report.solver.residual = relaxation_->balance().imbalance();
    report.solver.converged =
        solved_ && relaxation_->balance().imbalance() <= goal_;
    return solved_ && !report.solver.converged;
  }

  namespace
  {
    /** @p old with the faces open that have broken since. */
    template <int dim>
    State torn(const State &old,
               const std::vector<LocalSolution<dim>> &solutions)
    {
      State state = old;
      for (std::size_t i = 0; i < solutions.size(); ++i)
        if (solutions[i].damages && solutions[i].frozen.secant.normal == 0. &&
            solutions[i].frozen.secant.tangential == 0.)
          state.kind[i] = PointKind::free;
      return state;
    }
  } // namespace

  /** That the forces left over accelerate, if there is one. */
  template <int dim>
  void EquilibriumSearch<dim>::refuse_rigid_body_modes(const State &old,
                                                       const double time)
  {
    const std::string modes = rigid_body_modes(
        discretization_, *delassus_, torn(old, relaxation_->solutions()),
        relaxation_->balance().residual());
    if (modes.empty())
      return;
    throw StepRejected(
        fmt::format("no equilibrium at t = {:.6g}: the loads are not balanced, "
                    "and nothing holds {}",
                    time, modes));
  }

  /**
   * Rounds until the forces left over are below @p goal. What nothing holds is
   * refused by name if it comes from @p old, and else ends them.
   */
  template <int dim>
  bool EquilibriumSearch<dim>::settle(std::vector<double> &q,
                                      const unsigned int rounds,
                                      const double goal, StepReport &report,
                                      const State *const old)
  {
    double last = std::numeric_limits<double>::infinity(), near = 1e-3;
    bool &converged = report.solver.converged;
    converged = false;
    goal_ = goal;
    h_ = first_h_;
    const double least =
        hurried_ ? first_h_ * shortest_hurried : shortest * crossing_;
    for (unsigned int n = 0; n < rounds; ++n) {
      round(q, report);
      if (converged) {
        if (!relaxation_->bonds() || !relaxation_->bonds()->let_go())
          break;
        converged = false;
        last = std::numeric_limits<double>::infinity();
        continue;
      }
      if (!solved_) { // several solutions: closer to the last iterate
        if (h_ <= least)
          break;
        h_ = std::max(h_ / 4., least);
        last = std::numeric_limits<double>::infinity();
        ++counters_.step_changes;
        continue;
      }
      const double ratio = relaxation_->balance().imbalance() / last;
      last = relaxation_->balance().imbalance();
      if (h_ < first_h_) {
        h_ = std::min(2. * h_, first_h_);
        last = std::numeric_limits<double>::infinity();
        continue;
      }
      // what only masses resist stays as it is
      if (std::abs(ratio - 1.) < 1e-3) {
        if (old == nullptr)
          break;
        refuse_rigid_body_modes(*old, relaxation_->time());
      }
      if (ratio > 0.1 && last < near) {
        if (!accelerate(q, report))
          near = 0.1 * last;
        last = relaxation_->balance().imbalance();
      } else if (ratio > 0.5 && h_ < longest * crossing_) {
        h_ = std::min(4. * h_, longest * crossing_);
        last = std::numeric_limits<double>::infinity();
        ++counters_.step_changes;
      } else if (ratio > 0.5 && n > most_rounds / 4)
        near = std::numeric_limits<double>::infinity();
    }
    return converged;
  }

  /**
   * Springs in place of the laws, damaged as far as they have been opened,
   * again and again: as a motion goes that a damper slows down. Where
   * equilibria of the laws lie on its way it comes to the first of them; from
   * there on the laws themselves are solved. Damage that grows faster and
   * faster is hurried.
   */
  template <int dim>
  void EquilibriumSearch<dim>::follow_damped(std::vector<double> &q,
                                             StepReport &report)
  {
    // an opening over G/R_max: what the laws find by themselves
    constexpr double near = 1e-4, faster = 4.,
                     let_go = std::numeric_limits<double>::max();
    double last = let_go, growth, stretch = 1.;
    relaxation_->laws().hold();
    for (unsigned int n = 0; n < most_bits; ++n) {
      settle(q, most_held_rounds, std::max(input_.statics->tolerance, 1e-6),
             report, nullptr);
      if (!solved_ || !relaxation_->laws().let_damage_grow(growth, stretch))
        break;
      if (last < let_go && growth < let_go) {
        // growth goes by 1 - stretch (1 - x); half way to where x leads
        const double decay = (1. - growth / last) / stretch;
        if (growth < near * decay)
          break;
        stretch = 2. * faster * stretch * decay > 1. ? std::max(1., 0.5 / decay)
                                                     : faster * stretch;
      } else
        stretch = 1.;
      last = growth;
    }
    relaxation_->laws().release();
  }

  template <int dim>
  void EquilibriumSearch<dim>::find(const State &old, const double time,
                                    const Way way, State &next,
                                    StepReport &report)
  {
    std::vector<double> q = old.displacement;
    if (way == Way::held) {
      q = held_;
      relaxation_->laws().release();
    } else
      begin(old, time);
    if (way == Way::damped)
      follow_damped(q, report);
    if (!settle(q, most_rounds, input_.statics->tolerance, report, &old)) {
      refuse_rigid_body_modes(old, time);
      throw StepRejected(fmt::format(
          "no equilibrium was found at t = {:.6g}: {:.2e} of the forces are "
          "not balanced; worst face {}",
          time, relaxation_->balance().imbalance(), relaxation_->worst_face()));
    }
    take(old, time, q, next);
  }

  template class EquilibriumSearch<2>;
  template class EquilibriumSearch<3>;
} // namespace nsfd
