#pragma once

#include "nsfd/time/moreau_jean.h"

#include <memory>

namespace nsfd
{
  template <int dim>
  class Relaxation;
  template <int dim>
  class StaticLedger;

  /** An equilibrium, and how it lies to the one before it. */
  struct EquilibriumReport {
    StepReport step;
    double left_over = 0.; ///< energy that the cohesion did not take, J
    bool stable = true;    ///< softening leaves some stiffness everywhere
    bool jumps = false;    ///< not stable, or what is left over is no small
                           ///< part of what the step has moved
    std::string place;     ///< of the face with the largest share of it
  };

  /**
   * Equilibria under the loads and the prescribed motion of a time, without
   * inertia (section 3.1 of the report): rounds of long implicit steps from
   * rest, accelerated by KINSOL, until the forces left over are small against
   * those present. Has matrices, solver and scene of its own, with theta = 1
   * and cohesion at the end point, whatever the dynamic steps use.
   *
   * A step remembers only what its equilibrium says: damage, friction and
   * contact see the change from the equilibrium before it, not the rounds.
   */
  template <int dim>
  class QuasiStatic
  {
  public:
    /** The scene must ask for equilibria: SceneInput::statics. */
    QuasiStatic(const SceneInput &input, const Communicator &communicator,
                const Discretization<dim> &discretization);
    ~QuasiStatic();

    /**
     * The equilibrium at t = 0 next to @p given, in one step of the load. Its
     * energy is the initial energy. @throws StepRejected, for good.
     */
    State start(const State &given);

    /**
     * From the equilibrium @p old to @p next at @p time. @throws StepRejected
     * if none was found: no support, or none near @p old.
     */
    EquilibriumReport advance(const State &old, double time, State &next);

    /** Force on each driven boundary, dim per boundary. */
    const std::vector<double> &reactions() const;

    /** Of what a step moves; what is left over above it makes a jump. */
    static constexpr double jump_share = 0.01;

    void remember(Archive &archive);

    struct Counters {
      unsigned long long equilibria = 0, rounds = 0, step_changes = 0;
    };
    const Counters &counters() const { return counters_; }
    const typename MoreauJean<dim>::Counters &solver_counters() const;
    const typename MoreauJean<dim>::Timings &timings() const;
    const typename Dynamics<dim>::Counters &dynamics_counters() const
    {
      return dynamics_->counters();
    }

  private:
    void find(const State &old, double time, State &next, StepReport &report);
    bool round(std::vector<double> &q, StepReport &report);
    bool accelerate(std::vector<double> &q, StepReport &report);
    void refuse_loose_motion(const State &old, double time, double h);

    const SceneInput &input_;
    const std::unique_ptr<const SceneInput> scene_;
    const Communicator &communicator_;
    const Discretization<dim> &discretization_;
    std::unique_ptr<Dynamics<dim>> dynamics_;
    std::unique_ptr<NonsmoothSolver<dim>> solver_;
    std::unique_ptr<Relaxation<dim>> relaxation_;
    std::unique_ptr<StaticLedger<dim>> ledger_;
    double crossing_, h_; ///< s, of a cell; pseudo-time step of the rounds
    bool solved_ = true;  ///< the point laws, in the last round
    Counters counters_;
  };
} // namespace nsfd
