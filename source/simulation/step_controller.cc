#include "step_controller.h"

#include "core/stop_request.h"
#include "input/formula_check.h"
#include "nsfd/core/archive.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

namespace nsfd
{
  std::string bad_formulas_text(const Communicator &communicator)
  {
    return fmt::format("{}", fmt::join(bad_formulas(communicator), "; "));
  }

  template <int dim>
  void StepController<dim>::choose_step(const StepLimits &limits,
                                        const State &state)
  {
    auto &control = *model_.control;
    double limit = std::numeric_limits<double>::infinity();
    bool any = false;
    for (const auto &rule : rules_)
      if (const auto longest =
              rule->longest({input_.time, limits, control, state})) {
        limit = std::min(limit, *longest);
        any = true;
      }
    if (input_.large_motion && input_.time.scheme.at_nodes) {
      limit = std::min(limit, limits.stable_share() * model_.explicit_limit);
      any = true;
    }
    if (input_.time.scheme.explicit_forces) // of the present mesh
      limit = std::min(limit, model_.explicit_limit);
    if (!any)
      return;
    if (control.time() < redo_until_)
      limit = std::min(limit, redo_step_);
    control.limit(limit);
    control.set_ceiling(limit);
  }

  /** True if the step is to be repeated, by the first rule that says so. */
  template <int dim>
  bool StepController<dim>::is_too_long(const StepLimits &limits,
                                        const StepReport &report,
                                        const State &state, const State &next)
  {
    auto &control = *model_.control;
    if (!control.can_bisect())
      return false;
    for (const auto &rule : rules_)
      if (const auto shorter = rule->repeat(
              {input_.time, limits, control, state}, report, next)) {
        if (shorter->to_end) {
          redo_until_ = control.time() + control.step() * (1. - 1e-9);
          redo_step_ = shorter->length;
        }
        control.limit(shorter->length);
        ++repeated_;
        return true;
      }
    return false;
  }

  template <int dim>
  auto StepController<dim>::shorten(const TimeIntegrator<dim> &integrator,
                                    const StepRejected &rejected,
                                    std::string &failure) -> Outcome
  {
    using Cure = StepRejected::Cure;
    failure = rejected.what();
    if (rejected.cure() == Cure::next_integrator)
      return Outcome::handed_over;
    if (rejected.cure() == Cure::none)
      return Outcome::failed;
    if (!integrator.counts_rejected_steps())
      ++rejected_;
    ++attempts_;
    auto &control = *model_.control;
    const double length = control.step() * rejected.share();
    if (control.bisect()) {
      while (control.step() > length && control.bisect()) {
      }
      return Outcome::again;
    }
    failure += fmt::format("; {} bisections did not help",
                           input_.time.maximum_bisections);
    const auto &materials = input_.materials;
    if (input_.large_motion && !input_.time.scheme.at_nodes &&
        std::all_of(materials.begin(), materials.end(), [](const auto &m) {
          return m.kind == MaterialKind::finite_strain;
        }))
      failure += "; with scheme = explicit no step has a problem of all bodies "
                 "to solve";
    return Outcome::failed;
  }

  template <int dim>
  auto StepController<dim>::step(TimeIntegrator<dim> &integrator,
                                 const State &state, State &next,
                                 StepReport &report, std::string &failure)
      -> Outcome
  {
    auto &control = *model_.control;
    choose_step(integrator, state);
    StepRequest step;
    step.length = control.step();
    step.end = control.next_time();
    step.can_be_shorter = control.can_bisect();
    step.bisections = control.level();
    // A shorter step is the cure for a step with several solutions, but not
    // for every hard one: each further attempt may cost twice as much.
    // Where steps have become short already, work pays as well.
    step.idle_rounds <<=
        step.can_be_shorter
            ? std::min(std::max(attempts_, control.level()), 10u)
            : 10;
    // the one place that catches StepRejected and shortens the step
    try {
      // what keeps its motion by itself is not left in the middle of a step
      std::optional<stop_request::Interruptible> interruptible;
      if (!integrator.keeps_motion())
        interruptible.emplace(communicator_.size());
      report = integrator.take_step(state, step, next);
    } catch (const StepRejected &rejected) {
      failure = bad_formulas_text(communicator_);
      if (!failure.empty())
        return Outcome::failed;
      return shorten(integrator, rejected, failure);
    }
    // no shorter step makes numbers of what is none
    failure = bad_formulas_text(communicator_);
    if (!failure.empty())
      return Outcome::failed;
    return is_too_long(integrator, report, state, next) ? Outcome::again
                                                        : Outcome::taken;
  }

  template <int dim>
  void
  StepController<dim>::fill_counters(std::map<std::string, double> &c) const
  {
    c["rejected_steps"] = rejected_;
    c["redone_steps"] = repeated_;
  }

  template <int dim>
  void StepController<dim>::serialize(Archive &archive)
  {
    archive.numbers("step_controller", attempts_, redo_until_, redo_step_);
  }

  template class StepController<2>;
  template class StepController<3>;
} // namespace nsfd
