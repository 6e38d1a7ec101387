#include "quasi_static.h"

#include "nsfd/core/archive.h"

#include <fmt/format.h>

namespace nsfd
{
  namespace
  {
    /** What the certificate watches, of an equilibrium after @p old. */
    StepReport report_of(const EquilibriumReport &equilibrium, const State &old,
                         const State &next)
    {
      StepReport report = equilibrium.step;
      report.changes = changes_of_energy(old.energy, next);
      report.changes.taken[std::size_t(WatchedLine::load_steps)] =
          -equilibrium.above_mean;
      return report;
    }
  } // namespace

  template <int dim>
  QuasiStatic<dim>::QuasiStatic(const SceneInput &input,
                                const Discretization<dim> &discretization,
                                std::unique_ptr<DelassusOperator<dim>> delassus,
                                std::unique_ptr<NonsmoothSolver<dim>> solver)
      : statics_(*input.statics),
        search_(input, discretization, std::move(delassus), std::move(solver))
  {
  }

  template <int dim>
  StepReport QuasiStatic<dim>::advance(const State &old, const double time_step,
                                       State &next, const unsigned int)
  {
    StepRequest step;
    step.length = time_step;
    step.end = old.time + time_step;
    return take_step(old, step, next);
  }

  template <int dim>
  StepReport QuasiStatic<dim>::take_step(const State &old,
                                         const StepRequest &step, State &next)
  {
    if (statics_.at_jump == SolutionJump::arc_length) {
      StepReport report;
      if (!path_.on && take_load_step(old, step, next, report))
        return report;
      return follow_path(old, step, next);
    }
    const bool may_relax =
        statics_.at_jump == SolutionJump::relax &&
        (step.bisections >= statics_.jump_bisections || !step.can_be_shorter);
    EquilibriumReport equilibrium;
    std::string what;
    bool found = true;
    try {
      equilibrium = search_.advance(old, step.end, next,
                                    step.can_be_shorter && !may_relax);
    } catch (const StepRejected &rejected) {
      found = false;
      what = rejected.what();
    }
    StepReport report = equilibrium.step;
    if (found)
      report = report_of(equilibrium, old, next);
    if (found && equilibrium.accepted())
      return report;
    const bool may_follow = found && equilibrium.may_follow();
    if (step.can_be_shorter && !(may_relax && may_follow)) {
      ++shortened_;
      // to where the first point comes to its peak
      throw StepRejected(what, StepRejected::Cure::shorter_step,
                         equilibrium.share);
    }
    ++jumps_;
    if (jumps_ == 1)
      first_jump_ = old.time;
    if (may_follow) {
      released_ += equilibrium.released_energy;
      what = fmt::format(
          "solution jump between t = {:.8g} and {:.8g}: no equilibrium "
          "continues the last one, {:.6g} J are released; worst face {}",
          old.time, step.end, equilibrium.released_energy, equilibrium.place);
    } else if (found && equilibrium.skips_peak)
      what = fmt::format(
          "no equilibrium was found between t = {:.8g} and {:.8g} that does "
          "not skip the peak of a law: {} would be beyond it, and has reached "
          "{:.3g} of that traction; shorter steps of the load (`step`, "
          "`maximum bisections`) come closer",
          old.time, step.end, equilibrium.place, equilibrium.peak_seen);
    else if (found)
      what = fmt::format(
          "no equilibrium was found at t = {:.8g} that the energy at t = "
          "{:.8g} suffices for: {:.6g} J are missing; worst face {}",
          step.end, old.time, -equilibrium.released_energy, equilibrium.place);
    else
      what = fmt::format("solution jump after t = {:.8g}: {}", old.time, what);
    if (statics_.at_jump != SolutionJump::relax || !may_follow)
      refuse(what, may_follow);
    report.note = what + "; relaxes to the next equilibrium";
    return report;
  }

  /** True if an equilibrium at the load of its end continues the last one. */
  template <int dim>
  bool QuasiStatic<dim>::take_load_step(const State &old,
                                        const StepRequest &step, State &next,
                                        StepReport &report)
  {
    const double delay = path_.delay;
    try {
      const EquilibriumReport equilibrium =
          search_.advance(old, step.end - delay, next, true, delay);
      if (!equilibrium.accepted())
        return false;
      report = report_of(equilibrium, old, next);
    } catch (const StepRejected &) {
      return false;
    }
    next.time = step.end;
    return true;
  }

  template <int dim>
  StepReport QuasiStatic<dim>::follow_path(const State &old,
                                           const StepRequest &step, State &next)
  {
    PathFollowing path = path_;
    for (;;) {
      std::string failure;
      try {
        const PathReport taken = search_.follow(old, path.delay, step.length,
                                                path.share, path.points, next);
        if (taken.equilibrium.accepted()) {
          path.accept(taken);
          path.delay = step.end - taken.load_time;
          path_ = path;
          next.time = step.end;
          return report_of(taken.equilibrium, old, next);
        }
        failure = fmt::format(
            "{:.6g} J are not accounted for on the path of equilibria after "
            "the load time {:.8g}; worst face {}",
            taken.equilibrium.released_energy, old.time - path.delay,
            taken.equilibrium.place);
      } catch (const StepRejected &rejected) {
        if (rejected.cure() == StepRejected::Cure::none)
          throw;
        failure = rejected.what();
      }
      if (!path.shorten())
        throw StepRejected(failure, StepRejected::Cure::none);
    }
  }

  template <int dim>
  void QuasiStatic<dim>::refuse(const std::string &what,
                                const bool may_follow) const
  {
    using Cure = StepRejected::Cure;
    if (statics_.at_jump == SolutionJump::dynamic)
      throw StepRejected(what + "; goes on in dynamic steps",
                         Cure::next_integrator);
    throw StepRejected(
        what + (may_follow ? "\n  in section Time, `set at solution jump = "
                             "dynamic` follows it in time, `relax` takes "
                             "the next equilibrium"
                           : "\n  in section Time, `set at solution jump = "
                             "dynamic` follows what moves in time"),
        Cure::none);
  }

  template <int dim>
  void QuasiStatic<dim>::hand_over(State &state, const double time_step) const
  {
    state.impulse = state.point_force;
    for (double &P : state.impulse)
      P *= time_step;
    state.point_force.clear();
  }

  template <int dim>
  void
  QuasiStatic<dim>::fill_counters(std::map<std::string, double> &counters) const
  {
    const auto &found = search_.counters();
    const auto &solver = search_.solver_counters();
    counters["equilibria"] = double(found.equilibria);
    counters["equilibrium_rounds"] = double(found.rounds);
    counters["equilibrium_newton"] = double(solver.newton);
    counters["equilibrium_krylov"] = double(solver.krylov);
    counters["equilibrium_factorisations"] =
        double(search_.delassus_counters().global_factorisations);
    if (!takes_steps())
      return;
    counters["shortened_load_steps"] = shortened_;
    counters["solution_jumps"] = jumps_;
    if (statics_.at_jump == SolutionJump::arc_length)
      counters["path_steps"] = path_.steps;
    if (jumps_ > 0) {
      counters["solution_jump_energy"] = released_;
      counters["solution_jump_time"] = first_jump_;
    }
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  QuasiStatic<dim>::stage_seconds() const
  {
    const auto &spent = search_.timings();
    return {{"equilibria", spent.assembly + spent.solve + spent.update}};
  }

  template <int dim>
  void QuasiStatic<dim>::serialize(Archive &archive)
  {
    archive.numbers("solution_jumps", shortened_, jumps_, released_,
                    first_jump_);
    path_.serialize(archive);
  }

  template class QuasiStatic<2>;
  template class QuasiStatic<3>;
} // namespace nsfd
