#pragma once

#include "energy_watch.h"
#include "nonsmooth/solver.h"
#include "state/state.h"

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace nsfd
{
  /** A step that has to be redone shorter; the text says where and why. */
  class StepRejected : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
  };

  /** What an accepted step reports besides its state. */
  struct StepReport {
    SolverReport solver;
    double ledger_defect = 0.;  ///< of this step, relative
    LineChanges changes;        ///< of the energy balance
    unsigned int active = 0;    ///< points in contact or damaging
    bool beyond_unique = false; ///< step above the uniqueness bound
    unsigned int released = 0;  ///< points that leave their bond
    double overshoot = 0.; ///< their largest traction over the strength, less 1
    double share = 1.; ///< of the step at which the first of them reached it
  };

  /**
   * What takes a state over a step of time. Moreau-Jean in small motions,
   * around bodies of finite strain or with internal variables, and smooth
   * motion by ARKODE implement it.
   */
  template <int dim>
  class TimeIntegrator
  {
  public:
    virtual ~TimeIntegrator() = default;

    /**
     * From @p old over @p time_step (s) to @p next; @p old does not change. How
     * soon a solver may give up is @p idle_rounds, see SolverControl.
     * Collective. Errors raised: StepRejected.
     */
    virtual StepReport
    advance(const State &old, double time_step, State &next,
            unsigned int idle_rounds = SolverControl().idle_rounds) = 0;

    /** Force on each driven boundary in the last step, N, dim per boundary. */
    virtual const std::vector<double> &reactions() const = 0;

    /** What has been counted, under its names in summary.json. */
    virtual void
    fill_counters(std::map<std::string, double> &counters) const = 0;
  };
} // namespace nsfd
