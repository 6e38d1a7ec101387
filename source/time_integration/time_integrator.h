#pragma once

#include "energy_watch.h"
#include "nonsmooth/solver.h"
#include "state/state.h"

#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  class Archive;

  /** A step that was not taken; the text says where and why. */
  class StepRejected : public std::runtime_error
  {
  public:
    enum class Cure {
      shorter_step,
      next_integrator, ///< which goes on from the state before the step
      none
    };

    /** A shorter step should have at most @p share of the length. */
    explicit StepRejected(const std::string &reason,
                          const Cure cure = Cure::shorter_step,
                          const double share = 1.)
        : std::runtime_error(reason), cure_(cure), share_(share)
    {
    }
    Cure cure() const { return cure_; }
    double share() const { return share_; }

  private:
    Cure cure_;
    double share_;
  };

  /** A step that is asked for. */
  struct StepRequest {
    double length = 0.;          ///< s
    double end = 0.;             ///< s, without the round-off of start + length
    bool can_be_shorter = false; ///< shorter ones are left to be tried
    unsigned int bisections = 0; ///< of the step that was asked for
    unsigned int idle_rounds = SolverControl().idle_rounds;
  };

  /** What the residual of a step measures. */
  enum class ResidualKind {
    one_step_problem, ///< natural map of the point laws, relative
    force_balance,    ///< forces left over at an equilibrium, relative
    none              ///< the step is controlled by an estimate of its error
  };

  /** What an accepted step reports besides its state. */
  struct StepReport {
    SolverReport solver;
    double balance_residual = 0.; ///< of this step, relative
    LineChanges changes;          ///< of the energy balance
    unsigned int active = 0;      ///< points in contact or damaging
    bool beyond_unique = false;   ///< step above the uniqueness bound
    unsigned int released = 0;    ///< points that leave their bond
    double overshoot = 0.; ///< their largest traction over the strength, less 1
    double share = 1.; ///< of the step at which the first of them reached it
    bool separates = true; ///< a face may have lost its last hold
    std::string note;      ///< for the user, where there is something to say
  };

  /** How long steps may be, as far as an integrator knows. */
  class StepLimits
  {
  public:
    virtual ~StepLimits() = default;

    /** What `step = auto` takes from @p state, at most @p time_step (s). */
    virtual double automatic_step(const State &state, double time_step) const
    {
      (void)state;
      return time_step;
    }
    /** Of the bound of explicit steps at rest: what is stable from here. */
    virtual double stable_share() const { return 1.; }
    /**
     * Up to which length (s) a step has one solution, by the points that
     * softened between @p old and @p next.
     */
    virtual double unique_step(const State &old, const State &next) const
    {
      (void)old, (void)next;
      return std::numeric_limits<double>::infinity();
    }
    /** Share of unique_step() that `step = auto` takes. */
    static constexpr double bound_share = 0.95;
  };

  /**
   * What takes a state over a step of time. Moreau-Jean in small motions,
   * around bodies of finite strain or with internal variables, smooth motion by
   * ARKODE, and equilibria from one load to the next implement it.
   */
  template <int dim>
  class TimeIntegrator : public StepLimits
  {
  public:
    /**
     * What its first step starts from where the scene, or the integrator before
     * it, gives @p given. Collective. Errors raised: StepRejected.
     */
    virtual State start_from(State given) { return given; }
    /** Goes on from a stored @p state, before serialize(). Collective. */
    virtual void resume_from(const State &state) { (void)state; }
    /** False if all that it does is start_from(). */
    virtual bool takes_steps() const { return true; }

    /**
     * From @p old over @p time_step (s) to @p next; @p old does not change. How
     * soon a solver may give up is @p idle_rounds, see SolverControl.
     * Collective. Errors raised: StepRejected.
     */
    virtual StepReport
    advance(const State &old, double time_step, State &next,
            unsigned int idle_rounds = SolverControl().idle_rounds) = 0;

    /** The same for those that look at more than the length of a step. */
    virtual StepReport take_step(const State &old, const StepRequest &step,
                                 State &next)
    {
      return advance(old, step.length, next, step.idle_rounds);
    }

    /**
     * Makes @p state, the last one, what the next integrator takes, whose steps
     * have the length @p time_step (s).
     */
    virtual void hand_over(State &state, double time_step) const
    {
      (void)state, (void)time_step;
    }

    /**
     * True if it keeps bodies and points by itself, and those of a state are up
     * to date only after show().
     */
    virtual bool keeps_motion() const { return false; }
    /** Brings them up to date in @p state, the last one, and what no step needs
        but who looks at it. */
    virtual void show(State &state) const { (void)state; }

    /** Force on each driven boundary in the last step, N, dim per boundary. */
    virtual const std::vector<double> &reactions() const = 0;
    /** What the loads of @p state, the last one, are those of, s. */
    virtual double load_time(const State &state) const { return state.time; }
    virtual ResidualKind residual_kind() const
    {
      return ResidualKind::one_step_problem;
    }

    /** What has been counted, under its names in summary.json. */
    virtual void
    fill_counters(std::map<std::string, double> &counters) const = 0;
    /** Rejected steps are among that, under a name of their own. */
    virtual bool counts_rejected_steps() const { return false; }
    /** Seconds of CPU by stage of the step, in the order to print. */
    virtual std::vector<std::pair<std::string, double>> stage_seconds() const
    {
      return {};
    }

    /** What later steps depend on. Collective. */
    virtual void serialize(Archive &archive) { (void)archive; }
    /** What they only start from: not stored in the middle of a step. */
    virtual void serialize_solver(Archive &archive) { (void)archive; }
  };
} // namespace nsfd
