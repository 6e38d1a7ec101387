#pragma once

#include "nonsmooth/solver.h"

#include <cstdint>
#include <vector>

namespace nsfd
{
  struct SceneInput;

  /**
   * P_c,T . U_theta,T of a point in J, U_theta = theta U + (1 - theta) U_old;
   * impulses (N s) and velocities have dim components in its frame.
   */
  template <int dim>
  double friction_work(const OneStepProblem<dim> &problem, std::size_t i,
                       const LocalSolution<dim> &solution,
                       const double *impulse, const double *velocity,
                       const double *old_velocity, double theta);

  /**
   * Coulomb friction that never gives energy and still rests (`sliding = energy
   * safe`). Friction opposes U_T at the end of the step, so that what sticks is
   * at rest. Its work P_T . U_theta,T may then be positive: at an impact, and
   * where slip turns. At a point where it would be, friction opposes the mean
   * velocity U_theta,T in that step, and its work is never positive (Acary &
   * Collins-Craft 2025). A point changes over once in a step at most, so the
   * rounds end.
   */
  template <int dim>
  class EnergySafeSliding
  {
  public:
    explicit EnergySafeSliding(const SceneInput &input);

    /** Friction of a step at the end velocity everywhere. */
    void begin();

    /**
     * Writes the sliding offsets of @p problem: (1 - theta) / theta U_T,k where
     * friction opposes the mean velocity, zero elsewhere. @p old_velocity is
     * U_k by component, in the frames of the step, in m/s.
     */
    void apply(const std::vector<double> &old_velocity,
               OneStepProblem<dim> &problem) const;

    /**
     * The step was solved: points at which friction has given energy change
     * over. True, on all ranks, if there are any: solve again. A sum below
     * 1e-13 of @p energy, the largest of the scene in J, is what the solver
     * leaves of contacts at rest: 1e4 such steps keep the bound of the balance.
     */
    bool revise(const Communicator &communicator,
                const LawEvaluation<dim> &evaluation,
                const std::vector<double> &impulse,
                const std::vector<double> &old_velocity, double energy,
                OneStepProblem<dim> &problem);

  private:
    const double theta_; ///< of the velocity that impulses work with
    const bool always_;  ///< sliding = increment
    const bool chooses_; ///< sliding = energy safe, and there is friction
    std::vector<std::uint8_t> mean_; ///< by point; empty: nowhere yet
  };
} // namespace nsfd
