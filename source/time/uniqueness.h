#pragma once

#include "nsfd/dynamics/dynamics.h"
#include "nsfd/nonsmooth/one_step_problem.h"

#include <vector>

namespace nsfd
{
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
    UniquenessBound(const SceneInput &input, const Dynamics<dim> &dynamics);

    /** The left side at a cohesive point. */
    double ratio(const OneStepProblem<dim> &problem, std::size_t point,
                 double time_step) const;

    /** By the points that soften at @p state, else infinite. Collective. */
    double largest_step(const OneStepProblem<dim> &problem,
                        const State &state) const;

  private:
    void set_flexibility();

    const Dynamics<dim> &dynamics_;
    double theta_, chi_;
    std::vector<double> flexibility_; ///< per face
  };
} // namespace nsfd
