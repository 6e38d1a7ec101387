#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * A discrete Coulomb problem on its own, without bodies: find impulses r and
   * relative velocities u = W r + q such that at every contact, with
   * u^ = u + mu |u_T| e_N,
   *
   *     r in K,   u^ in K*,   u^ . r = 0,    K = { r : |r_T| <= mu r_N }.
   *
   * Blocks of `dimension` components per contact, the normal one first
   * (positive: opening for u, compression for r). W may be unsymmetric,
   * singular, and indefinite by round-off.
   */
  struct ContactProblem {
    unsigned int dimension = 3; ///< 2 or 3

    // W by rows: columns and values of row i at row_start[i] .. [i + 1]
    std::vector<int> row_start, column;
    std::vector<double> value;

    std::vector<double> q;        ///< dimension per contact
    std::vector<double> friction; ///< mu, one per contact
    std::vector<double> guess;    ///< r to start from; empty: none
    std::vector<double> solution; ///< r of a reference solution; empty: none

    std::string title, description, math_info; ///< free text of the file

    std::size_t n_contacts() const { return friction.size(); }
    std::size_t n_rows() const { return q.size(); }
  };

  /** @p velocity = W r + q. */
  void relative_velocity(const ContactProblem &problem,
                         const std::vector<double> &impulse,
                         std::vector<double> &velocity);

  /**
   * The one measure that every solver is judged by, the relative natural map
   * of Siconos (`fc3d_compute_error`, version 4.4): with u = W r + q computed
   * from r and P_K the orthogonal projection on the cone,
   *
   *     err = ( sum |r - P_K(r - u^)|^2 )^(1/2) / max(|q|, |r|, |u|),
   *
   * Euclidean norms over all contacts; the numerator alone if the denominator
   * is below 2.2e-16. Not a number where r is not finite.
   */
  double natural_map_error(const ContactProblem &problem,
                           const std::vector<double> &impulse);

  /** The same where u = W r + q is known. */
  double natural_map_error(const ContactProblem &problem,
                           const std::vector<double> &impulse,
                           const std::vector<double> &velocity);
} // namespace nsfd
