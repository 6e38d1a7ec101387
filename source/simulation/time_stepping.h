#pragma once

#include "step_controller.h"

namespace nsfd
{
  /**
   * The integrators of a run, one after the other, and their steps: equilibria
   * where the scene asks for them, then what moves in time.
   */
  template <int dim>
  class TimeStepping
  {
  public:
    TimeStepping(const SceneInput &input, Model<dim> &model,
                 const Communicator &communicator)
        : input_(input), model_(model), communicator_(communicator),
          controller_(input, model, communicator)
    {
    }

    /**
     * Makes of @p state what the first step starts from. Collective. Errors
     * raised: StepRejected.
     */
    void start(State &state);

    /**
     * Whether the end of the run is reached. Where one integrator has come to
     * its end, the next one takes @p state. Collective.
     */
    bool finished(State &state);

    enum class Outcome {
      taken,
      again, ///< to be repeated: shorter, or by the next integrator
      failed
    };

    /**
     * A step from @p state to @p next, or the reason in @p failure. Collective.
     */
    Outcome step(State &state, State &next, StepReport &report,
                 std::string &failure);

    /** The step was accepted: the step levels goes on. */
    void accept();

    TimeIntegrator<dim> &integrator() const
    {
      return *model_.integrators()[stage_];
    }

    void fill_counters(std::map<std::string, double> &counters) const;

    /** Another integrator follows. */
    bool is_first_of_two() const
    {
      return stage_ + 1 < model_.integrators().size();
    }
    /** Equilibria are found, nothing moves in time yet. */
    bool is_static() const { return model_.equilibria && stage_ == 0; }
    /**
     * As stored, from @p state on; before serialize(). Collective. Errors
     * raised: BadCheckpoint if it moves and the scene has no steps in time.
     */
    void resume(const State &state, bool is_static);
    /**
     * What later steps depend on; of @p all integrators, or of the present one
     * alone. Collective.
     */
    void serialize(Archive &archive, bool all);
    /** What solvers keep from step to step. Collective. */
    void serialize_solvers(Archive &archive);
    /** Other steps, or to another end. Errors raised: BadCheckpoint. */
    void renew_steps(const State &state);

  private:
    void hand_over(State &state);

    const SceneInput &input_;
    Model<dim> &model_;
    const Communicator &communicator_;
    StepController<dim> controller_;
    std::size_t stage_ = 0; ///< among Model::integrators()
  };
} // namespace nsfd
