#pragma once

#include "free_motion.h"
#include "step_problem.h"

#include "nsfd/scene/scene_input.h"
#include "state/state.h"

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
    /** @p input is a static_scene() and outlives this. */
    Relaxation(const SceneInput &input,
               const Discretization<dim> &discretization,
               Dynamics<dim> &dynamics, NonsmoothSolver<dim> &solver);

    /**
     * From the equilibrium @p old, which outlives the rounds, to loads and
     * motion at @p time, after @p duration of prescribed velocities.
     */
    void begin(const State &old, double time, double duration);

    /** q := q'. The residual of the point laws is solved to @p tolerance. */
    SolverReport relax(std::vector<double> &q, double h, double tolerance);

    /**
     * From now on the rounds see what the laws are as long as nothing is
     * damaged beyond its history: springs, and joints that do not let go. The
     * equilibrium of that is unique but for contact, no round goes astray, and
     * it is the one sought where no point is damaged in it. Until begin().
     */
    void hold_laws();
    /** Where those rounds have come to. */
    struct Prediction {
      bool damages = false; ///< some point does not stay what it was held to be
      /// of the step until the first point comes to its peak that is not there
      /// yet, by straight lines; 1: none does
      double share = 1.;
      bool certain = false;  ///< lines are right: it is elastic to its peak
      std::size_t point = 0; ///< local, where this rank has the first one
    };
    /** Collective, after held rounds that have settled. */
    Prediction prediction();
    /**
     * The same springs, of points that are damaged as far as the last held
     * rounds have opened them, and @p stretch times the growth: the next ones
     * along the path of an overdamped motion. False if nothing grows.
     */
    bool let_damage_grow(double &largest_growth, double stretch);
    /** Laws again, next to where the held rounds have ended. */
    void free_laws();
    /** Points have laws that damage, on any rank. */
    bool has_laws() const;
    /**
     * The point that has skipped the peak of its law furthest in the step from
     * the last equilibrium to @p next, see Passage; 1 where none has. What was
     * damaged on an overdamped @p path has seen what it carried on it.
     */
    std::pair<double, std::size_t> least_passage(const State &next,
                                                 bool path) const;

    /**
     * |F + H^T r - K q'| over the largest forces that were present so far: what
     * is broken may carry none at all. Round-off of K q counts as a force.
     */
    double imbalance() const { return imbalance_; }
    /** F + H^T r - K q' at all unknowns. */
    const std::vector<double> &residual() const { return residual_; }

    /**
     * How much of its stiffness softening takes from the scene at the last
     * round: the largest eigenvalue of
     *
     *     G^{1/2} H A^{-1} H^T G^{1/2},     G = w h^2 (T/d - T'(d)),
     *
     * along the opening of the points that damage, A the scene with all
     * cohesion at its secant. From 1 on the equilibrium is not stable: (38) of
     * the report as a number.
     */
    double softening();

    /** Data of the step of the load as a whole, over the last h. */
    const OneStepProblem<dim> &load_step();
    /** Of the last round: r in N, local solutions, forces, pressure. */
    const std::vector<double> &point_force() const { return force_; }
    const std::vector<LocalSolution<dim>> &solutions() const
    {
      return solutions_;
    }
    /** The largest forces so far. */
    void serialize(Archive &archive);

    const std::vector<double> &forces() const { return free_motion_.loads(); }
    const std::vector<double> &pressure() const { return pressure_; }
    /** Of the equilibrium that is looked for, s. */
    double time() const { return time_; }
    std::string worst_face() const { return face(worst_point_); }
    std::string face(std::size_t point) const;

    const StepTimings &timings() const { return timings_; }
    const StepCounters &counters() const { return counters_; }

  private:
    void set_start(std::size_t point, Reach &start) const;
    void hold();
    bool may_damage(std::size_t point) const;
    Reach history(std::size_t point) const;
    Reach held_reach(std::size_t point) const;
    void constrain(double h);
    void soften(double h);
    void set_support();
    void set_scales();
    double forces_present(const std::vector<double> &q) const;
    void measure(const std::vector<double> &q, double h,
                 const std::vector<double> &velocity);

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    Dynamics<dim> &dynamics_;
    NonsmoothSolver<dim> &solver_;
    StepTimings timings_;
    StepCounters counters_;
    OneStepProblem<dim> problem_;
    FreeMotion<dim> free_motion_;
    StepProblem<dim> step_problem_;

    const State *old_ = nullptr;
    State at_; ///< the iterate as the start of a step
    double time_ = 0., h_ = 0.;
    std::vector<double> target_; ///< jumps of driven points
    std::vector<char> let_go_;   ///< extrinsic points that opened in this step
    std::vector<double> force_, pressure_, residual_;
    std::vector<LocalSolution<dim>> solutions_;
    bool holds_ = false;                    ///< laws are springs
    std::vector<Reach> held_;               ///< histories of these springs
    std::vector<Interaction> interactions_; ///< of the laws
    std::vector<unsigned int> interaction_; ///< of the points in these
    std::vector<double> joint_loads_;       ///< over the strength, at the start
    bool joint_loads_known_ = false;
    std::vector<double> support_; ///< w kappa of the points, N/m
    double round_off_ = 0., point_round_off_ = 0.; ///< as the next two
    double present_ = 0.;     ///< largest forces at an equilibrium, N
    double point_scale_ = 0.; ///< largest sum of r^2/(w kappa), J
    double imbalance_ = 0.;
    std::size_t worst_point_ = 0;
  };
} // namespace nsfd
