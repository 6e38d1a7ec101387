#pragma once

#include "run_costs.h"
#include "run_facts.h"
#include "run_totals.h"
#include "time_stepping.h"

#include "core/stopwatch.h"

namespace nsfd
{
  /** What a run counts and sums up over its accepted steps. */
  template <int dim>
  class RunTally
  {
  public:
    RunTally(const SceneInput &input, const Model<dim> &model,
             const TimeStepping<dim> &steps, const Communicator &communicator);

    /** An accepted step of TimeStepping::integrator(). */
    void add(const StepReport &report);

    /** The parts are built and the first files are open. */
    void set_up() { setup_seconds_ = cpu_seconds() - setup_start_; }
    double setup_seconds() const { return setup_seconds_; }

    /** The run goes on from a checkpoint. */
    void resume() { resumed_ = true; }

    /**
     * All counters and timings, with those before the checkpoint. @p output
     * are the seconds of CPU spent on files.
     */
    RunTotals totals(const State &state, double output,
                     unsigned int failed_checkpoints) const;

    double balance_residual_max() const { return balance_residual_max_; }
    double residual_max() const { return residual_max_; }
    const SolvedSteps &solved_steps() const { return solved_steps_; }
    const EnergyWatch &watch() const { return watch_; }
    /** Collective. */
    CostRecord costs() const
    {
      return costs_.finish(communicator_, model_.delassus.get());
    }

    /** Arguments as of totals(). Collective. */
    void serialize(Archive &archive, const State &state, double output,
                   unsigned int failed_checkpoints);

  private:
    RunTotals of_process(const State &state, double output,
                         unsigned int failed_checkpoints) const;
    void fill_counters(const State &state,
                       std::map<std::string, double> &counters) const;

    const SceneInput &input_;
    const Model<dim> &model_;
    const TimeStepping<dim> &steps_;
    const Communicator &communicator_;
    const double wall_start_, setup_start_;
    double setup_seconds_ = 0.;
    bool resumed_ = false;
    RunCosts<dim> costs_;
    SolvedSteps solved_steps_;
    EnergyWatch watch_; ///< of the lines that must not give energy
    double balance_residual_max_ = 0., residual_max_ = 0.;
    unsigned int beyond_unique_ = 0;
    unsigned long long released_ = 0; ///< bonds
    std::map<std::string, unsigned int> switches_;
    EarlierTotals earlier_; ///< before the checkpoint, if resumed
  };
} // namespace nsfd
