#pragma once

#include "nonsmooth/solver.h"

#include <algorithm>
#include <vector>

namespace nsfd
{
  /**
   * T and right-hand side of supports in a step from rest at the velocities
   * @p U, the same T in every Newton step: dP = T (U_given - U - dU). What they
   * give way by, over R, knows the stiffness of the bodies: beside stiffer
   * rows, of 1e14 times a mass, round-off is as large as the mass that alone
   * holds a body which turns about its support.
   */
  template <int dim>
  void hold_supports(const OneStepProblem<dim> &problem,
                     const LawEvaluation<dim> &evaluation,
                     const std::vector<double> &U, std::vector<double> &T,
                     std::vector<double> &right_side)
  {
    constexpr double compliance = 1e-6;
    for (const std::size_t i : problem.acting) {
      if (problem.kind[i] != PointKind::prescribed)
        continue;
      double *const own = &T[i * dim * dim];
      std::fill_n(own, dim * dim, 0.);
      for (unsigned int c = 0; c < dim; ++c) {
        const std::size_t k = i * dim + c;
        if (!(problem.mask[i] & (1u << c)))
          continue;
        own[c * dim + c] = 1. / (compliance * evaluation.majorant(i, c));
        right_side[k] = own[c * dim + c] * (problem.given_velocity[k] - U[k]);
      }
    }
  }

  /** Of such a support at the velocities @p U: what is left of the given one,
      over R, N s. */
  template <int dim>
  double left_of_support(const OneStepProblem<dim> &problem,
                         const std::vector<double> &U, const double R,
                         const std::size_t point, const unsigned int c)
  {
    const std::size_t k = point * dim + c;
    return problem.mask[point] & (1u << c)
               ? (problem.given_velocity[k] - U[k]) / R
               : 0.;
  }
} // namespace nsfd
