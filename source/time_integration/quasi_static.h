#pragma once

#include "path_following.h"

#include "nsfd/scene/scene_input.h"

namespace nsfd
{
  /**
   * Equilibria from one load to the next as steps of a run: the first is the
   * equilibrium at t = 0. A step is rejected where no equilibrium is found or
   * one leaves energy over; where no shorter one is left to be tried, the scene
   * says whether that ends the run, or its integrator of dynamics goes on, or
   * the next equilibrium is taken with a note. With the arc length as the
   * control no step is rejected: where no equilibrium continues the last one at
   * the load of its end, the step follows the path of equilibria, on which the
   * loads may run backwards.
   */
  template <int dim>
  class QuasiStatic final : public TimeIntegrator<dim>
  {
  public:
    /**
     * The scene must ask for equilibria: SceneInput::statics. @p delassus and
     * @p solver are as for EquilibriumSearch.
     */
    QuasiStatic(const SceneInput &input,
                const Discretization<dim> &discretization,
                std::unique_ptr<DelassusOperator<dim>> delassus,
                std::unique_ptr<NonsmoothSolver<dim>> solver);

    State start_from(State given) override { return search_.start(given); }
    bool takes_steps() const override { return statics_.steps; }

    StepReport advance(const State &old, double time_step, State &next,
                       unsigned int idle_rounds) override;
    /** The load is that of the end of the step. */
    StepReport take_step(const State &old, const StepRequest &step,
                         State &next) override;

    /** At rest, with the impulses of its forces. */
    void hand_over(State &state, double time_step) const override;

    const std::vector<double> &reactions() const override
    {
      return search_.reactions();
    }
    double load_time(const State &state) const override
    {
      return state.time - path_.delay;
    }
    ResidualKind residual_kind() const override
    {
      return ResidualKind::force_balance;
    }
    bool counts_rejected_steps() const override { return true; }
    void fill_counters(std::map<std::string, double> &counters) const override;
    std::vector<std::pair<std::string, double>> stage_seconds() const override;

    void serialize(Archive &archive) override;
    void serialize_solver(Archive &archive) override
    {
      search_.serialize(archive);
    }

    EquilibriumSearch<dim> &search() { return search_; }

  private:
    bool take_load_step(const State &old, const StepRequest &step, State &next,
                        StepReport &report);
    StepReport follow_path(const State &old, const StepRequest &step,
                           State &next);
    [[noreturn]] void refuse(const std::string &what, bool may_follow) const;

    const StaticInput &statics_;
    EquilibriumSearch<dim> search_;
    PathFollowing path_;
    unsigned int shortened_ = 0, jumps_ = 0;
    double released_ = 0., first_jump_ = 0.; ///< J; s
  };
} // namespace nsfd
