#pragma once

#include "model.h"

#include "time_integration/step_rule.h"
#include "time_integration/time_integrator.h"

#include <map>
#include <string>

namespace nsfd
{
  /**
   * How long a step of time is: the base step, bisected where a step is
   * rejected or where a rule asks for a shorter one, see StepRule. The step
   * levels of bisected steps are Model::control.
   */
  template <int dim>
  class StepController
  {
  public:
    StepController(const SceneInput &input, Model<dim> &model,
                   const Communicator &communicator)
        : input_(input), model_(model), communicator_(communicator),
          rules_(step_rules(input.time))
    {
    }

    enum class Outcome {
      taken,
      again,       ///< to be repeated, shorter
      handed_over, ///< by the integrator: the next one goes on from the state
      failed
    };

    /**
     * A step of @p integrator from @p state. Formulas that gave no number, and
     * a step that no bisection helps, are failures, with the reason in
     * @p failure; so is why a step was handed over. Collective.
     */
    Outcome step(TimeIntegrator<dim> &integrator, const State &state,
                 State &next, StepReport &report, std::string &failure);

    /** The step was accepted by everybody else as well. */
    void accept() { attempts_ = 0; }
    /** Attempts of another integrator do not count. */
    void restart() { attempts_ = 0; }

    void fill_counters(std::map<std::string, double> &counters) const;
    void serialize(Archive &archive);

  private:
    void choose_step(const StepLimits &limits, const State &state);
    bool is_too_long(const StepLimits &limits, const StepReport &report,
                     const State &state, const State &next);
    Outcome shorten(const TimeIntegrator<dim> &integrator,
                    const StepRejected &rejected, std::string &failure);

    const SceneInput &input_;
    Model<dim> &model_;
    const Communicator &communicator_;
    const StepRules rules_;
    unsigned int rejected_ = 0, repeated_ = 0;
    unsigned int attempts_ = 0; ///< at the present step, all rejected
    double redo_until_ = 0., redo_step_ = 0.; ///< s, by a rule
  };

  /** Sentences on formulas that gave no number; empty if none. Collective. */
  std::string bad_formulas_text(const Communicator &communicator);
} // namespace nsfd
