#pragma once

#include "point_law.h"

#include <array>

namespace nsfd
{
  /**
   * T = -dS/dU_loc (dim x dim, kg by rows of S) of the answer S of a point that
   * solve_point() has found for @p local against A_N and A_T: exact where
   * nothing is damaged, sliding friction with it, and else by difference
   * quotients. @return whether it is symmetric.
   */
  template <int dim>
  bool point_tangent(const OneStepProblem<dim> &problem, std::size_t point,
                     const LocalSolution<dim> &solution,
                     const std::array<double, dim> &local, double A_N,
                     double A_T, double *T);

  /** Difference quotients leave five digits of T. */
  template <int dim>
  bool has_difference_quotients(const OneStepProblem<dim> &problem,
                                std::size_t point,
                                const LocalSolution<dim> &solution);
} // namespace nsfd
