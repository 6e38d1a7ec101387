#pragma once

#include "contact_problem.h"

#include <array>
#include <vector>

namespace nsfd::stored
{
  /**
   * A stored problem as the solvers see it: W in d x d blocks by rows of
   * contacts, in units in which the diagonal of W and q are of order 1,
   *
   *     W = W_stored / w,  u = u_stored / s,  r = r_stored w / s,
   *
   * w the mean diagonal entry of W, s the largest |q|. The error is that of
   * natural_map_error(), which does not scale r against u: `unit` = 1 / w
   * turns r into the unit it is judged in.
   */
  template <int d>
  struct BlockProblem {
    static constexpr int area = d * d;

    explicit BlockProblem(const ContactProblem &stored);

    int n = 0; ///< contacts
    std::vector<int> start, column;
    std::vector<int> diagonal; ///< index of W_ii; always there
    std::vector<double> block; ///< row-major
    std::vector<double> q, mu;
    double unit = 1.;
    double impulse_unit = 1.; ///< r_stored / r
    double q_norm = 0.;

    const double *diagonal_block(const int i) const
    {
      return &block[std::size_t(area) * diagonal[i]];
    }

    /** u = W r + q. */
    void velocity(const double *r, double *u) const;
    /** x -> W x */
    void multiply(const double *x, double *y) const;
    double error(const double *r, const double *u) const;
  };
} // namespace nsfd::stored
