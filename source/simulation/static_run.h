#pragma once

#include "model.h"

namespace nsfd
{
  /**
   * Quasi-static steps of a run: down the ladder where no equilibrium is found
   * or a step leaves energy over, and what the scene wants at its end.
   */
  template <int dim>
  class StaticRun
  {
  public:
    StaticRun(const SceneInput &input, Model<dim> &model,
              const Communicator &communicator)
        : input_(input), model_(model), communicator_(communicator)
    {
    }

    enum class Outcome {
      accepted,
      shortened,   ///< the step is to be taken again
      to_dynamics, ///< from the last equilibrium
      failed
    };

    /** One step of the load. @p text says why, if it is not accepted. */
    Outcome step(const State &state, State &next, StepReport &report,
                 std::string &text);

    void fill_counters(std::map<std::string, double> &counters) const;

    void remember(Archive &archive);

  private:
    Outcome jump(const std::string &what, bool may_relax, std::string &text);

    const SceneInput &input_;
    Model<dim> &model_;
    const Communicator &communicator_;
    unsigned int shortened_ = 0, jumps_ = 0;
    double released_ = 0., first_jump_ = 0.;
  };
} // namespace nsfd
