#pragma once

#include <cstddef>
#include <vector>

namespace nsfd
{
  /**
   * A few contacts with Coulomb friction in two dimensions, exactly: impulses r
   * and velocities u = W r + q, two rows per contact (normal, tangential), with
   *
   *     0 <= r_N  complementary to  u_N >= 0,   |r_T| <= mu r_N,
   *     u_T r_T = -mu r_N |u_T|.
   *
   * As a linear complementarity problem of three rows per contact, by Lemke's
   * method: pivots decide open, stick or slide of all contacts together, where
   * Newton's method goes round between them. @p W is dense, row-major, may be
   * singular and unsymmetric. A few dozen contacts: the work is of order
   * contacts^2 per pivot. @p seed chooses the ray the method comes from.
   * False if it ends on a ray or after too many pivots; r is then not touched.
   */
  bool solve_by_lemke(const std::vector<double> &W,
                      const std::vector<double> &q,
                      const std::vector<double> &friction, unsigned int seed,
                      std::vector<double> &r);
} // namespace nsfd
