#pragma once

#include "step_costs.h"
#include "time_integrator.h"

#include "delassus/delassus_operator.h"
#include "discretization/discretization.h"

#include <memory>

namespace nsfd
{
  template <int dim>
  class JoinedDelassus;
  template <int dim>
  class Relaxation;
  template <int dim>
  class StaticBalance;

  /** An equilibrium, and how it lies to the one before it. */
  struct EquilibriumReport {
    StepReport step;
    double released_energy = 0.; ///< energy that the cohesion did not take, J
    double above_mean = 0.; ///< work of the loads above that of their mean, J
    double round_off = 0.;  ///< energy that counts as none, J
    bool stable = true;     ///< softening leaves some stiffness everywhere
    bool jumps = false;     ///< not stable, or what is left over or missing is
                            ///< no small part of what the step has moved
    /// a point is beyond the peak of its law, and was never pulled as far as a
    /// hundredth below it
    bool skips_peak = false;
    double peak_seen = 1.;       ///< the most that it has seen of it
    bool starts_at_peak = false; ///< another point that damages was there
    /// of the step to take instead, where that can be told
    double share = 1.;
    std::string place; ///< of the face that is worst in this

    /** No continuation, but what may follow one: downhill, over the peak. */
    bool may_follow() const
    {
      return !skips_peak && released_energy >= -round_off;
    }
    bool accepted() const { return !jumps && !skips_peak; }
  };

  /** A step along a path of equilibria as it was taken. */
  struct PathReport {
    EquilibriumReport equilibrium;
    double load_time = 0.;   ///< of the loads at its end, s
    double dissipated = 0.;  ///< by the laws, J
    double points = 0.;      ///< that share it: (sum d)^2 / sum d^2
    bool at_longest = false; ///< the load time has gone as far as it may
    unsigned int rounds = 0; ///< of springs
  };

  /**
   * Equilibria under the loads and the prescribed motion of a time, without
   * inertia (section 3.1 of [AM06]): rounds of long implicit steps from
   * rest, accelerated by KINSOL, until the forces left over are small against
   * those present. Has matrices, solver and scene of its own, with theta = 1
   * and cohesion at the end point, whatever the dynamic steps use.
   *
   * A step keeps only what its equilibrium says: damage, friction and
   * contact see the change from the equilibrium before it, not the rounds.
   *
   * Softening leaves several equilibria. The one that continues the last is
   * looked for where nothing is damaged yet, then with the laws next to the
   * last one, and, where that has gone astray, along the path of an overdamped
   * motion: damage grows as far as it must, bit by bit.
   */
  template <int dim>
  class EquilibriumSearch
  {
  public:
    /**
     * The scene must ask for equilibria: SceneInput::statics. @p delassus is
     * one of small motions, of its own; a JoinedDelassus if faces are bonded.
     */
    EquilibriumSearch(const SceneInput &input,
                      const Discretization<dim> &discretization,
                      std::unique_ptr<DelassusOperator<dim>> delassus,
                      std::unique_ptr<NonsmoothSolver<dim>> solver);
    ~EquilibriumSearch();

    /**
     * The equilibrium at t = 0 next to @p given, in one step of the load. Its
     * energy is the initial energy. @throws StepRejected, for good.
     */
    State start(const State &given);

    /**
     * From the equilibrium @p old to @p next at the load time @p time, which
     * becomes its time. @throws StepRejected if none was found: no support, or
     * none near @p old. If the step @p may_be_shortened, one that is bound to
     * skip a peak is not even solved. The loads of @p old are @p delay (s)
     * behind its time.
     */
    EquilibriumReport advance(const State &old, double time, State &next,
                              bool may_be_shortened = false, double delay = 0.);

    /**
     * From the equilibrium @p old to @p next on the path of equilibria where
     * the load time is an unknown, through limit points and back: it goes on by
     * @p longest (s) at most, and the laws dissipate @p share of the toughness
     * of a point, times @p points, at most. Its time is the load time.
     * @throws StepRejected if none was found.
     */
    PathReport follow(const State &old, double delay, double longest,
                      double share, double points, State &next);

    /** Force on each driven boundary, dim per boundary. */
    const std::vector<double> &reactions() const;

    /** Of what a step moves; what is left over above it makes a jump. */
    static constexpr double jump_share = 0.01;

    void serialize(Archive &archive);

    struct Counters {
      unsigned long long equilibria = 0, rounds = 0, step_changes = 0;
    };
    const Counters &counters() const { return counters_; }
    /** The constant data of the points. */
    const OneStepProblem<dim> &points() const;
    const StepCounters &solver_counters() const;
    const StepTimings &timings() const;
    const typename DelassusOperator<dim>::Counters &delassus_counters() const
    {
      return delassus_->counters();
    }

  private:
    enum class Way { held, near, damped };
    void find(const State &old, double time, Way way, State &next,
              StepReport &report);
    EquilibriumReport try_way(const State &old, double time, Way way, bool path,
                              State &next);
    bool settle(std::vector<double> &q, unsigned int rounds, double goal,
                StepReport &report, const State *old);
    void follow_damped(std::vector<double> &q, StepReport &report);
    std::string face_of_all(double value, std::size_t point) const;
    bool round(std::vector<double> &q, StepReport &report);
    bool accelerate(std::vector<double> &q, StepReport &report);
    void begin(const State &old, double time);
    void take(const State &old, double time, const std::vector<double> &q,
              State &next);
    bool settle_springs(std::vector<double> &q, StepReport &report);
    void respond(const State &old, double time, double aside,
                 std::vector<double> &q, StepReport &report);
    void refuse_rigid_body_modes(const State &old, double time);

    const SceneInput &input_;
    const std::unique_ptr<const SceneInput> scene_;
    const Communicator &communicator_;
    const Discretization<dim> &discretization_;
    std::unique_ptr<DelassusOperator<dim>> delassus_;
    std::unique_ptr<NonsmoothSolver<dim>> solver_;
    std::unique_ptr<Relaxation<dim>> relaxation_;
    std::unique_ptr<StaticBalance<dim>> balance_;
    /// s: across a cell, or what holds what floats as well; pseudo-time step
    /// of the rounds
    double crossing_, h_;
    double start_ = 0.; ///< load time of the equilibrium before the step, s
    double first_h_;    ///< of every solve
    double goal_ = 0.;  ///< of the rounds: share of the forces left over
    std::vector<double> held_; ///< where springs in place of laws balance
    bool solved_ = true;       ///< the point laws, in the last round
    bool hurried_ = false;     ///< a shorter step of the load is cheaper
    Counters counters_;
  };
} // namespace nsfd
