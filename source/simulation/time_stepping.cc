#include "time_stepping.h"

#include "print_problems.h"

#include "nsfd/core/archive.h"

#include <fmt/format.h>

namespace nsfd
{
  template <int dim>
  void TimeStepping<dim>::start(State &state)
  {
    // where there may be no equilibrium the given state is what is written then
    state = integrator().start_from(input_.statics ? State(state)
                                                   : std::move(state));
    if (!integrator().takes_steps())
      hand_over(state);
  }

  /** From the last state of one integrator to the next one. */
  template <int dim>
  void TimeStepping<dim>::hand_over(State &state)
  {
    const TimeIntegrator<dim> &last = integrator();
    if (last.takes_steps()) // or the step levels is that of the next one
                            // already
      model_.control = model_.dynamic_control(input_, state.time);
    last.hand_over(state, model_.control->step());
    controller_.restart();
    ++stage_;
    state = integrator().start_from(std::move(state));
  }

  template <int dim>
  bool TimeStepping<dim>::finished(State &state)
  {
    if (!model_.control->finished())
      return false;
    if (!is_first_of_two() || model_.control->time() >= input_.time.end)
      return true;
    hand_over(state);
    return false;
  }

  template <int dim>
  auto TimeStepping<dim>::step(State &state, State &next, StepReport &report,
                               std::string &failure) -> Outcome
  {
    using Result = typename StepController<dim>::Outcome;
    const auto note = [this](const std::string &text) {
      print_problems(communicator_, input_, "note", {text});
    };
    if (input_.time.scheme.explicit_forces)
      model_.keep_longest_step();
    switch (controller_.step(integrator(), state, next, report, failure)) {
    case Result::taken:
      if (!report.note.empty())
        note(report.note);
      return Outcome::taken;
    case Result::again:
      return Outcome::again;
    case Result::handed_over:
      note(failure);
      hand_over(state);
      return Outcome::again;
    case Result::failed:
      break;
    }
    return Outcome::failed;
  }

  template <int dim>
  void TimeStepping<dim>::accept()
  {
    controller_.accept();
    model_.control->accept();
  }

  template <int dim>
  void TimeStepping<dim>::fill_counters(std::map<std::string, double> &c) const
  {
    controller_.fill_counters(c);
    // summaries have the same keys
    if (model_.other && model_.stepper)
      model_.stepper->fill_counters(c);
    else if (model_.equilibria)
      nsfd::fill_counters(StepCounters(), c);
    for (const TimeIntegrator<dim> *one : model_.integrators())
      one->fill_counters(c);
  }

  template <int dim>
  void TimeStepping<dim>::resume(const State &state, const bool is_static)
  {
    if (!is_static && !input_.may_move())
      throw BadCheckpoint(fmt::format(
          "the bodies move in time at t = {:.6g} s, and this scene has steps "
          "of the load alone: write `set at solution jump = dynamic` in "
          "section Time, as it was",
          state.time));
    stage_ = is_static ? 0 : model_.integrators().size() - 1;
    integrator().resume_from(state);
  }

  template <int dim>
  void TimeStepping<dim>::serialize(Archive &archive, const bool all)
  {
    controller_.serialize(archive);
    model_.control->serialize(archive);
    for (TimeIntegrator<dim> *one : model_.integrators())
      if (all || one == &integrator())
        one->serialize(archive);
  }

  template <int dim>
  void TimeStepping<dim>::serialize_solvers(Archive &archive)
  {
    const Archive::Part part(archive, "solver");
    if (model_.delassus)
      model_.delassus->serialize(archive);
    if (model_.solver)
      model_.solver->serialize(archive);
    for (TimeIntegrator<dim> *one : model_.integrators())
      one->serialize_solver(archive);
  }

  template <int dim>
  void TimeStepping<dim>::renew_steps(const State &state)
  {
    const double time = state.time;
    const double end =
        is_first_of_two() ? input_.statics->until : input_.time.end;
    if (!(end > time * (1. + 1e-12)))
      throw BadCheckpoint(fmt::format(
          "Time/end = {:.6g} s is not after t = {:.6g} s", end, time));
    if (input_.time.scheme.at_nodes && state.last_step > 0.)
      model_.control = std::make_unique<StepControl>(
          StepControl::of_length(state.last_step, end, time));
    else
      model_.control = is_first_of_two() ? model_.load_control(input_, time)
                                         : model_.dynamic_control(input_, time);
  }

  template class TimeStepping<2>;
  template class TimeStepping<3>;
} // namespace nsfd
