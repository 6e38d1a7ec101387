#pragma once

#include "free_motion.h"
#include "step_check.h"
#include "step_costs.h"
#include "step_problem.h"
#include "time_integrator.h"

#include "discretization/discretization.h"

#include <memory>

namespace nsfd
{
  struct SceneInput;
  template <int dim>
  class EnergyBalance;
  template <int dim>
  class UniquenessBound;

  /**
   * The implicit Moreau-Jean scheme: theta scheme in the bulk, velocity-level
   * contact, impulses of all points in one nonsmooth problem (report, 5.2-5.3).
   * Every energy line of a step is computed on its own. Here is what its steps
   * have in common; LinearMoreauJean and NewtonMoreauJean move the bodies.
   */
  template <int dim>
  class MoreauJean : public TimeIntegrator<dim>
  {
  public:
    MoreauJean(const SceneInput &input,
               const Discretization<dim> &discretization,
               DelassusOperator<dim> &delassus);
    ~MoreauJean() override;

    /** State at t = 0: positions, velocities, gaps, broken points. */
    virtual State initial_state() const = 0;

    /**
     * The motion and the points of @p state are known: its stored energies,
     * bonds and their tractions.
     */
    virtual void complete(State &state) const = 0;

    /**
     * Up to which a step has one solution, by the points that soften at
     * @p state; infinite if there is none.
     */
    double unique_step(const State &state) const;
    double unique_step(const State &old, const State &next) const override;
    double automatic_step(const State &state, double time_step) const override;

    const std::vector<double> &reactions() const override;
    void fill_counters(std::map<std::string, double> &counters) const override;
    std::vector<std::pair<std::string, double>> stage_seconds() const override;

    /** Of the points of the mesh. */
    const OneStepProblem<dim> &problem() const { return problem_; }

    using Timings = StepTimings;
    const Timings &timings() const { return timings_; }
    using Counters = StepCounters;
    const Counters &counters() const { return counters_; }
    /** Counts go on where those of another mesh have ended. */
    void continue_counters(const Timings &timings, const Counters &counters)
    {
      timings_ = timings;
      counters_ = counters;
    }

  protected:
    /** See StepCheck. */
    virtual std::string describe(std::size_t point) const = 0;

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    DelassusOperator<dim> &delassus_;
    Timings timings_;
    Counters counters_;
    OneStepProblem<dim> problem_;
    std::unique_ptr<UniquenessBound<dim>> uniqueness_;
    std::unique_ptr<EnergyBalance<dim>> balance_;
    FreeMotion<dim> free_motion_;
    StepProblem<dim> step_problem_;
    StepCheck check_;
  };
} // namespace nsfd
