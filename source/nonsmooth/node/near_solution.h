#pragma once

#include "nonsmooth/point_law.h"

namespace nsfd
{
  /**
   * solve_point() against R times the identity where an answer is near: the
   * point damages and ends about @p end.opening. The end is followed from
   * there, with two or three evaluations of the law in place of a search. False
   * where that does not get to the round-off of the end, and where a point
   * has no single opening; then @p solution says nothing.
   */
  template <int dim>
  bool solve_near(const OneStepProblem<dim> &problem, std::size_t point,
                  const std::array<double, dim> &local, double R,
                  const Reach &end, LocalSolution<dim> &solution);
} // namespace nsfd
