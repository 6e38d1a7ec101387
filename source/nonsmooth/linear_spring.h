#pragma once

#include "point_law.h"

namespace nsfd
{
  /**
   * The law of one component of a LinearPoint by itself, P = -k (y_0 + s U):
   * nothing of it comes from P and U at hand, whose round-off a stiff spring
   * would raise to more than P.
   */
  struct LinearSpring {
    double stiffness = 0.; ///< k = w h b, N s/m; 0: nothing acts
    double offset = 0.;    ///< y_0, m
    double slope = 0.;     ///< s, s

    template <int dim>
    LinearSpring(const OneStepProblem<dim> &problem,
                 const LinearPoint<dim> &law, const std::size_t row)
        : stiffness(
              problem.weight[row / dim] * problem.time_step *
              (row % dim == 0 ? law.secant.normal : law.secant.tangential)),
          offset(law.offset[row % dim]), slope(law.slope)
    {
    }

    /** D = -dU/dP, in m/(N s^2). */
    double compliance() const { return 1. / (stiffness * slope); }
    /** U of P = 0. */
    double free_velocity() const { return -offset / slope; }
    /** U of the impulse @p P. */
    double velocity(const double P) const
    {
      return free_velocity() - compliance() * P;
    }
  };
} // namespace nsfd
