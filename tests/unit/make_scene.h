#pragma once

#include "input/read_scene.h"
#include "parameters/bad_values.h"
#include "simulation/model.h"
#include "time_integration/linear_moreau_jean.h"
#include "time_integration/newton_moreau_jean.h"

#include <fmt/format.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  namespace test
  {
    /** What a parameter file says, which must be right. */
    inline std::unique_ptr<SceneInput>
    make_input(const std::string &text,
               const std::vector<std::string> &overrides = {})
    {
      InputErrors errors;
      auto input = read_scene_text(text, "test.prm", overrides, errors);
      if (!input)
        throw std::invalid_argument(errors.report());
      return input;
    }

    /** What outlives the parts of a scene. */
    struct SceneBase {
      std::unique_ptr<SceneInput> input;
      Communicator communicator{MPI_COMM_WORLD};
    };

    /**
     * The parts of a run without its output: its factory builds them from the
     * text of a parameter file. @p overrides are `Section/name=value`.
     */
    template <int dim>
    class Scene : public SceneBase, public Model<dim>
    {
    public:
      explicit Scene(const std::string &text,
                     const std::vector<std::string> &overrides = {})
          : SceneBase{make_input(text, overrides)}
      {
        take_bad_values(); // of formulas that tests before this one evaluated
        const auto problems = this->build(*input, communicator);
        if (!problems.empty())
          throw std::invalid_argument(
              fmt::format("{}", fmt::join(problems, "\n")));
        time_step = this->dynamic_step(*input);
        if (this->delassus)
          this->delassus->reinit(time_step, input->time.bulk_theta());
        state = this->initial_state();
        next = state;
      }

      /** One step of the length that the input names. */
      StepReport advance() { return advance(time_step); }

      /** @throws StepRejected */
      StepReport advance(const double h, const unsigned int attempts = 0)
      {
        const StepReport report = this->stepper->advance(
            state, h, next, SolverControl().idle_rounds << attempts);
        std::swap(state, next);
        return report;
      }

      /**
       * One step, bisected as often as it takes to be solved, like a run does.
       * Returns its length.
       */
      double advance_bisecting()
      {
        double h = time_step;
        for (unsigned int level = 0; level < 10; ++level, h /= 2.)
          try {
            advance(h, level);
            return h;
          } catch (const StepRejected &) {
          }
        advance(h, 10);
        return h;
      }

      /** Kinetic, elastic and stored in the interfaces. */
      double energy() const
      {
        const EnergyLines &e = state.energy;
        return e.kinetic + e.elastic + e.cohesive;
      }

      double time_step = 0.;
      State state;
      State next; ///< after a step: the state before it
    };
  } // namespace test
} // namespace nsfd
