#pragma once

#include "delassus/delassus_operator.h"
#include "nonsmooth/one_step_problem.h"

#include <vector>

namespace nsfd
{
  struct PointOrigin;
  struct SceneInput;
  struct State;

  /**
   * The step up to which softening leaves one solution: with the flexibility
   * phi = w (lambda_1 + lambda_2) of a face, lambda the largest eigenvalue of
   * the weighted W of a body with the mass alone (an upper bound for every
   * step), it is unique as long as
   *
   *     h^2 theta chi f^2 s phi < 1
   *
   * at all softening points; s the steepest softening of the law, f the
   * strength factor, chi = 1/2 for the exact rule, else 1.
   */
  template <int dim>
  class UniquenessBound
  {
  public:
    /** Collective. Without a cohesive law the flexibilities are zero. */
    UniquenessBound(const SceneInput &input,
                    const std::vector<PointOrigin> &origins,
                    const DelassusOperator<dim> &delassus);

    /** The left side at a cohesive point. */
    double ratio(const OneStepProblem<dim> &problem, std::size_t point,
                 double time_step) const;

    /** By the points that soften at @p state, else infinite. Collective. */
    double largest_step(const OneStepProblem<dim> &problem,
                        const State &state) const;

    /** By the points that softened between @p old and @p next. Collective. */
    double largest_step(const OneStepProblem<dim> &problem, const State &old,
                        const State &next) const;

    /**
     * The step to take next, at most @p time_step. A point that its velocity
     * carries to where it softens, or softens on, allows @p share of its bound,
     * or half of the time until then if that is longer. Collective.
     */
    double next_step(const OneStepProblem<dim> &problem, const State &state,
                     double time_step, double share) const;

  private:
    void set_flexibility(const SceneInput &input,
                         const std::vector<PointOrigin> &origins);
    double bound(const OneStepProblem<dim> &problem, std::size_t point) const;

    const DelassusOperator<dim> &delassus_;
    double theta_, chi_;
    std::vector<double> flexibility_; ///< per face
  };
} // namespace nsfd
