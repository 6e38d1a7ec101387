#pragma once

#include "discretization/discretization.h"
#include "nsfd/core/archive.h"
#include "nsfd/scene/boundary_input.h"
#include "state/state.h"
#include "time_integration/time_integrator.h"

#include <map>
#include <string>
#include <vector>

namespace nsfd
{
  struct SceneInput;

  /**
   * What a run does when points break: Boundary blocks hold from the accepted
   * step on in which their event happens, and the run ends when no point has
   * broken for as many steps as the scene says. What has happened is in the
   * state.
   */
  template <int dim>
  class CrackEvents
  {
  public:
    explicit CrackEvents(const SceneInput &input) : input_(input) {}

    /** Before the first step; @p state, of the mesh, is shown. Collective. */
    void start(const Discretization<dim> &discretization,
               const Communicator &communicator, State &state);

    /**
     * The step from @p previous to @p state is accepted. Sentences on what has
     * happened. Collective.
     */
    std::vector<std::string> accept(const State &previous,
                                    const TimeIntegrator<dim> &integrator,
                                    const Discretization<dim> &discretization,
                                    const Communicator &communicator,
                                    State &state);

    /** The crack has rested for long enough. */
    bool ends_run(const State &state) const;

    /** When loads have stopped, s, by the name of their block. */
    void fill_counters(const State &state,
                       std::map<std::string, double> &counters) const;

    void serialize(Archive &archive)
    {
      archive.numbers("faces_broken_at_start", broken_faces_);
    }

  private:
    bool waits_for(CrackEvent event, const State &state) const;

    const SceneInput &input_;
    double broken_faces_ = 0.; ///< at the start, m or m^2
  };
} // namespace nsfd
