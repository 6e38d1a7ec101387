#pragma once

#include "body_system.h"

#include "nonsmooth/solver.h"

#include <vector>

namespace nsfd
{
  /**
   * The laws of all points at an evaluation, linearised as they are: friction
   * and damage in the derivative. With Phi = P - P*(U - R P) the natural map
   * and J = dP*\/dU_loc,
   *
   *     (I + J R) dP = J dU - Phi,   so   dP = -B Phi - S dU,
   *     B = (I + J R)^{-1},   S = -B J.
   *
   * A point that sticks or is held has J R = -1: R is taken a share 1e-7
   * smaller, which makes S a stiffness 1e7 / R and not infinite. It changes
   * the way, not the solution, and where W is singular it chooses the impulses
   * nearest to those before. A larger softening makes the step a proximal one.
   */
  template <int dim>
  class LinearisedLaws
  {
  public:
    /** @p where: only at points with a nonzero entry; empty: everywhere. */
    void update(const OneStepProblem<dim> &problem,
                const LawEvaluation<dim> &evaluation,
                const std::vector<double> &impulse,
                const std::vector<char> &where = {});

    std::vector<double> stiffness; ///< S, dim x dim per point
    std::vector<double> change;    ///< -B Phi, dim per point
    double softening = 1e-7;

  private:
    std::array<double, dim * dim>
    derivative(const OneStepProblem<dim> &problem,
               const LawEvaluation<dim> &evaluation,
               const std::vector<double> &impulse, std::size_t point) const;
  };

  /**
   * Newton's method on the natural map of the full laws, each step with a
   * factor of the bodies joined by S. Where a step does not halve the error the
   * next ones are softer, from 1e-3 on: proximal steps, which do not run off
   * along impulses that move next to nothing. Given up after @p patience such
   * steps in a row, or two at the largest softness that leave the error as it
   * was. True if it ends below the tolerance; @p impulse and the evaluation are
   * those of the smallest error, @p softening is what the last good step had:
   * that of the first one.
   */
  template <int dim>
  bool newton_refinement(const OneStepProblem<dim> &problem,
                         BodySystem<dim> &system,
                         const DelassusOperator<dim> &delassus,
                         double tolerance, unsigned int patience,
                         double &softening, std::vector<double> &impulse,
                         LawEvaluation<dim> &evaluation, SolverReport &report);
} // namespace nsfd
