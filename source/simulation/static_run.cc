#include "static_run.h"

#include "core/archive.h"

#include <fmt/format.h>

#include <iostream>

namespace nsfd
{
  template <int dim>
  auto StaticRun<dim>::step(const State &state, State &next, StepReport &report,
                            std::string &text) -> Outcome
  {
    auto &control = *model_.control;
    StepControl after = control;
    after.accept();
    EquilibriumReport equilibrium;
    std::string what;
    bool found = true;
    try {
      equilibrium = model_.quasi_static->advance(state, after.time(), next,
                                                 control.can_halve());
    } catch (const StepRejected &rejected) {
      found = false;
      what = rejected.what();
    }
    if (found && equilibrium.accepted()) {
      report = equilibrium.step;
      return Outcome::accepted;
    }
    // to where the first point comes to its peak
    const double step = control.step() * equilibrium.share;
    if (control.halve()) {
      while (found && control.step() > step && control.halve()) {
      }
      ++shortened_;
      return Outcome::shortened;
    }
    ++jumps_;
    if (jumps_ == 1)
      first_jump_ = state.time;
    const bool may_follow = found && equilibrium.may_follow();
    if (may_follow) {
      released_ += equilibrium.left_over;
      what = fmt::format(
          "solution jump between t = {:.8g} and {:.8g}: no equilibrium "
          "continues the last one, {:.6g} J are left over; worst face {}",
          state.time, after.time(), equilibrium.left_over, equilibrium.place);
    } else if (found && equilibrium.skips_peak)
      what = fmt::format(
          "no equilibrium was found between t = {:.8g} and {:.8g} that does "
          "not skip the peak of a law: {} would be beyond it, and has seen "
          "{:.3g} of that traction; shorter steps of the load (`step`, "
          "`maximum halvings`) come closer",
          state.time, after.time(), equilibrium.place, equilibrium.peak_seen);
    else if (found)
      what = fmt::format(
          "no equilibrium was found at t = {:.8g} that the energy at t = "
          "{:.8g} suffices for: {:.6g} J are missing; worst face {}",
          after.time(), state.time, -equilibrium.left_over, equilibrium.place);
    else
      what =
          fmt::format("solution jump after t = {:.8g}: {}", state.time, what);
    report = equilibrium.step;
    return jump(what, may_follow, text);
  }

  template <int dim>
  auto StaticRun<dim>::jump(const std::string &what, const bool may_relax,
                            std::string &text) -> Outcome
  {
    switch (input_.statics->at_jump) {
    case SolutionJump::dynamic:
      print_problems(communicator_, input_, "note",
                     {what + "; goes on in dynamic steps"});
      return Outcome::to_dynamics;
    case SolutionJump::relax:
      if (may_relax) {
        print_problems(communicator_, input_, "note",
                       {what + "; relaxes to the next equilibrium"});
        return Outcome::accepted;
      }
      [[fallthrough]];
    default:
      text = what + (may_relax ? "\n  in section Time, `set at solution jump = "
                                 "dynamic` follows it in time, `relax` takes "
                                 "the next equilibrium"
                               : "\n  in section Time, `set at solution jump = "
                                 "dynamic` follows what moves in time");
      return Outcome::failed;
    }
  }

  template <int dim>
  void
  StaticRun<dim>::fill_counters(std::map<std::string, double> &counters) const
  {
    const auto &found = model_.quasi_static->counters();
    const auto &solver = model_.quasi_static->solver_counters();
    const auto &dynamics = model_.quasi_static->dynamics_counters();
    counters["equilibria"] = double(found.equilibria);
    counters["equilibrium_rounds"] = double(found.rounds);
    counters["equilibrium_newton"] = double(solver.newton);
    counters["equilibrium_krylov"] = double(solver.krylov);
    counters["equilibrium_factorisations"] =
        double(dynamics.global_factorisations);
    if (!input_.statics->steps)
      return;
    counters["shortened_load_steps"] = shortened_;
    counters["solution_jumps"] = jumps_;
    if (jumps_ > 0) {
      counters["solution_jump_energy"] = released_;
      counters["solution_jump_time"] = first_jump_;
    }
  }

  template <int dim>
  void StaticRun<dim>::remember(Archive &archive)
  {
    archive.numbers("solution_jumps", shortened_, jumps_, released_,
                    first_jump_);
  }

  template class StaticRun<2>;
  template class StaticRun<3>;
} // namespace nsfd
