#pragma once

#include "energy_safe_sliding.h"
#include "step_costs.h"

#include "delassus/delassus_operator.h"
#include "discretization/discretization.h"
#include "nonsmooth/one_step_problem.h"
#include "nonsmooth/solver.h"

#include <memory>
#include <vector>

namespace nsfd
{
  struct SceneInput;
  struct State;
  template <int dim>
  class DrivenMotion;

  /** The nonsmooth problem of a step: its data, and its solution in rounds. */
  template <int dim>
  class StepProblem
  {
  public:
    /** Work goes into @p counters. */
    StepProblem(const SceneInput &input,
                const Discretization<dim> &discretization,
                DelassusOperator<dim> &delassus, StepCounters &counters);
    ~StepProblem();

    /** What the input asks of the solver of a round of statics. */
    SolverControl control(unsigned int idle_rounds) const;
    /** Of a step from @p old: what contacts and rows may give as well. */
    SolverControl control(unsigned int idle_rounds, double time_step,
                          const State &old) const;

    /** Bodies that rest will be left where they are: see MovingBodies::stay().
     */
    void let_stay(const bool may) { may_stay_ = may; }

    /** A step begins: friction opposes the velocity at its end everywhere. */
    void begin() { sliding_.begin(); }

    /** The data of the step from @p old, see set_step(), and the velocities
        that friction opposes. Collective. */
    void set(const std::vector<PointOrigin> &origins, const State &old,
             double time_step, OneStepProblem<dim> &problem) const;

    /**
     * Again as long as extrinsic points reach their strength (unless @p
     * keeps_joints), or friction gives energy; @p old as it was for set().
     * Contacts of bodies at rest are solved to round-off, unless these stay
     * where they are: then the report says that they rest. Rows with a
     * prescribed velocity are solved to a share of what the run may give by
     * them. Collective.
     */
    SolverReport
    solve(NonsmoothSolver<dim> &solver, OneStepProblem<dim> &problem,
          const std::vector<PointOrigin> &origins, const SolverControl &control,
          double energy_scale, const State &old, std::vector<double> &impulse,
          LawEvaluation<dim> &evaluation, bool keeps_joints = false);

    /** Contacts of this solution give more than @p control allows. Collective.
     */
    bool gives_by_contact(const OneStepProblem<dim> &problem,
                          const SolverControl &control, const State &old,
                          const std::vector<double> &impulse,
                          const LawEvaluation<dim> &evaluation) const;

    /** Rows of this solution give more than @p control allows, and than
        round-off of their velocities does. Collective. */
    bool gives_by_rows(const OneStepProblem<dim> &problem,
                       const SolverControl &control, double energy_scale,
                       const std::vector<double> &impulse,
                       const LawEvaluation<dim> &evaluation) const;

    /** Some points are rigid until they reach the strength of their law. */
    bool has_extrinsic() const { return has_extrinsic_; }
    const DrivenMotion<dim> &motion() const { return *motion_; }

  private:
    void solve_closer(NonsmoothSolver<dim> &solver,
                      const OneStepProblem<dim> &problem, SolverControl control,
                      double energy_scale, std::vector<double> &impulse,
                      LawEvaluation<dim> &evaluation, SolverReport &report);
    bool rests(double still, const OneStepProblem<dim> &problem,
               double energy_scale, const State &old,
               const LawEvaluation<dim> &evaluation) const;
    void settle(const OneStepProblem<dim> &problem, SolverControl control,
                double energy_scale, std::vector<double> &impulse,
                LawEvaluation<dim> &evaluation, SolverReport &report);
    void hold_rows(const OneStepProblem<dim> &problem, SolverControl control,
                   double energy_scale, std::vector<double> &impulse,
                   LawEvaluation<dim> &evaluation, SolverReport &report);
    void renew_rows(NonsmoothSolver<dim> &solver,
                    const OneStepProblem<dim> &problem,
                    const SolverControl &control, double energy_scale,
                    std::vector<double> &impulse,
                    LawEvaluation<dim> &evaluation, SolverReport &report);
    bool go_on(const OneStepProblem<dim> &problem, const SolverControl &control,
               double energy_scale, std::vector<double> &impulse,
               LawEvaluation<dim> &evaluation, SolverReport &report);

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    DelassusOperator<dim> &delassus_;
    StepCounters &counters_;
    std::unique_ptr<DrivenMotion<dim>> motion_;
    EnergySafeSliding<dim> sliding_;
    bool has_extrinsic_ = false, may_stay_ = false;
  };

  /**
   * U of the points under the impulses of @p evaluation, m/s. U_free + W P is
   * not known better than to the last bit of its largest part, R |P|. Where the
   * spring of a point, D = -dU/dP, makes impulses of that which are larger than
   * P, its own law tells U from P.
   */
  template <int dim>
  std::vector<double> solved_velocity(const OneStepProblem<dim> &problem,
                                      const LawEvaluation<dim> &evaluation,
                                      const std::vector<double> &impulse);
} // namespace nsfd
