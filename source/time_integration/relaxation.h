#pragma once

#include "driven_jumps.h"
#include "force_balance.h"
#include "held_laws.h"
#include "path_laws.h"
#include "static_bonds.h"
#include "step_problem.h"

#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  /** A scene as an equilibrium sees it: backward Euler from rest, no rates. */
  SceneInput static_scene(const SceneInput &input);

  /**
   * One implicit step from rest, so long that masses hardly matter: with
   * theta = 1 and cohesion at the end point
   *
   *     (M/h^2) (q' - q) + K q' = F + H^T r,     r = P/h in the point laws,
   *
   * the proximal map of the potential energy, which equilibria leave where
   * they are. The mass holds what floats. Everything a step of the load
   * keeps is taken from the equilibrium before it: d_m, the sliding
   * (u_T - u_T,k in place of h U_T) and the gap, u_N >= 0 in place of its
   * velocity. So the iterates q leave no trace, and the equilibrium obeys the
   * laws over the step of the load exactly.
   *
   * The local solves see an elastic support, R = 1/(w h^2 kappa), instead of
   * the mass of a floating cell: kappa the stiffness E/L of a cell, or twice
   * the steepest softening, below which a local solve has several solutions.
   * The natural map then weighs errors of jumps as errors of forces.
   */
  template <int dim>
  class Relaxation
  {
  public:
    /**
     * @p input is a static_scene() and outlives this; @p bonded is @p delassus
     * where the scene has bonded faces, else null.
     */
    Relaxation(const SceneInput &input,
               const Discretization<dim> &discretization,
               DelassusOperator<dim> &delassus, NonsmoothSolver<dim> &solver,
               JoinedDelassus<dim> *bonded);

    /**
     * From the equilibrium @p old, which outlives the rounds, to loads and
     * motion at the load time @p time, after @p duration of prescribed
     * velocities.
     */
    void begin(const State &old, double time, double duration);
    /** The same rounds go on to other loads. */
    void aim(double time, double duration);

    /** q := q'. The residual of the point laws is solved to @p tolerance. */
    SolverReport relax(std::vector<double> &q, double h, double tolerance);

    /** Laws held as springs, and how far points are from their peaks. */
    HeldLaws<dim> &laws() { return laws_; }
    /** The same where the load time is unknown. */
    PathLaws<dim> &path_laws() { return path_laws_; }
    /** w kappa of the points, N/m. */
    const std::vector<double> &support() const { return support_; }
    /** Of bodies that share nodes, or null. */
    StaticBonds<dim> *bonds() { return bonds_.get(); }
    /** Of the last round, by the largest forces so far. */
    ForceBalance<dim> &balance() { return balance_; }

    /**
     * How much of its stiffness softening takes from the scene at the last
     * round: the largest eigenvalue of
     *
     *     G^{1/2} H A^{-1} H^T G^{1/2},     G = w h^2 (T/d - T'(d)),
     *
     * along the opening of the points that damage, A the scene with all
     * cohesion at its secant. From 1 on the equilibrium is not stable: (38) of
     * [AM06] as a number.
     */
    double softening();

    /** Data of the step of the load as a whole, over the last h. */
    const OneStepProblem<dim> &load_step();
    const OneStepProblem<dim> &points() const { return problem_; }
    /** Of the last round: r in N, local solutions, forces, pressure. */
    const std::vector<double> &point_force() const { return iterate_.force; }
    const std::vector<LocalSolution<dim>> &solutions() const
    {
      return iterate_.solutions;
    }
    const std::vector<double> &forces() const { return free_motion_.loads(); }
    const std::vector<double> &pressure() const { return pressure_; }
    /** Of the loads of the equilibrium that is looked for, s. */
    double time() const { return time_; }
    std::string worst_face() const { return face(worst_point_); }
    std::string face(std::size_t point) const;

    const StepTimings &timings() const { return timings_; }
    const StepCounters &counters() const { return counters_; }

  private:
    void set_start(std::size_t point, Reach &start) const;
    void constrain(double h);
    void soften(double h);
    void set_support();

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    DelassusOperator<dim> &delassus_;
    NonsmoothSolver<dim> &solver_;
    StepTimings timings_;
    StepCounters counters_;
    OneStepProblem<dim> problem_;
    FreeMotion<dim> free_motion_;
    StepProblem<dim> step_problem_;

    ForceBalance<dim> balance_;
    LoadStepIterate<dim> iterate_;
    std::unique_ptr<StaticBonds<dim>> bonds_; ///< or null
    HeldLaws<dim> laws_;
    PathLaws<dim> path_laws_;
    double time_ = 0.;
    DrivenJumps<dim> driven_;
    std::vector<double> pressure_;
    std::vector<double> support_; ///< w kappa of the points, N/m
    std::size_t worst_point_ = 0;
  };
} // namespace nsfd
