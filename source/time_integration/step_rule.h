#pragma once

#include "step_control.h"
#include "time_integrator.h"

#include "nsfd/core/registry.h"
#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <memory>
#include <optional>
#include <vector>

namespace nsfd
{
  class SectionReader;

  /** What rules look at: the step from @p state, of control.step(). */
  struct PresentStep {
    const TimeInput &time;
    const StepLimits &limits; ///< what the integrator knows
    const StepControl &control;
    const State &state;
  };

  /** A solved step that is to be repeated. */
  struct ShorterStep {
    double length = 0.;  ///< s, at most
    bool to_end = false; ///< all steps up to the end of the present one
  };

  /**
   * Why a step is shorter than the base step although it can be solved. A class
   * in one file that registers itself; without a state of its own.
   */
  class StepRule
  {
  public:
    virtual ~StepRule() = default;

    /** Rules are asked in this order, those of equal place by their names. */
    virtual unsigned int place() const { return 100; }

    /** Read the entries of the rule in section Time, or refuse them. */
    virtual void read(SectionReader &, SceneInput &) const {}

    /** Whether it may have anything to say in a run. */
    virtual bool applies(const TimeInput &time) const = 0;

    /** The longest step (s); nothing: the base step. Collective. */
    virtual std::optional<double> longest(const PresentStep &) const
    {
      return std::nullopt;
    }

    /** Where the solved step to @p next is to be repeated. Collective. */
    virtual std::optional<ShorterStep> repeat(const PresentStep &view,
                                              const StepReport &report,
                                              const State &next) const = 0;
  };

  using StepRuleRegistry = Registry<StepRule>;

  using StepRules = std::vector<std::unique_ptr<const StepRule>>;

  /** In the order in which they are asked. */
  StepRules all_step_rules();
  StepRules step_rules(const TimeInput &time); ///< those that apply
} // namespace nsfd
