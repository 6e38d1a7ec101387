#pragma once

#include "nonsmooth/point_law.h"

namespace nsfd
{
  /**
   * D = -dP/dU_loc of solve_point() at @p solution, its answer to @p local,
   * against R times the identity: dim x dim, by rows. Friction follows the
   * contact impulse and the secant the end of the step; where the law of a
   * point is no single equation (two damage scalars, dilatancy, wear) it is a
   * difference. Not symmetric where a point slides. One element of the
   * generalised derivative at a kink.
   */
  template <int dim>
  void point_slopes(const OneStepProblem<dim> &problem, std::size_t point,
                    const std::array<double, dim> &local, double R,
                    const LocalSolution<dim> &solution,
                    std::array<double, dim * dim> &slopes);
} // namespace nsfd
