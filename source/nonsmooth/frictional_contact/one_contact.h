#pragma once

#include "contact_cone.h"
#include "linear_algebra/small_matrix.h"

#include <limits>

namespace nsfd::stored
{
  /**
   * The Coulomb problem of one contact, u = A r + b, solved exactly:
   *
   *   open   r = 0                       if b_N >= 0,
   *   stick  r = -A^-1 b                 if that lies in the cone,
   *   slide  u_N = 0, u_T = -lambda r_T  else.
   *
   * With r_N = -(b_N + a_NT r_T) / a_NN from u_N = 0, sliding is
   * (S + lambda I) r_T = -c with the Schur complement S, and one scalar
   * equation |r_T(lambda)| = mu r_N(lambda), lambda > 0, is left. Its sides
   * change order between 0 (no stick) and infinity (r_N > 0, r_T = 0), so
   * there is a root for every A with a_NN > 0 and S + lambda I regular.
   *
   * What does not depend on b is computed once. A block without a positive
   * a_NN, or a singular one, gets a multiple of the identity above the
   * round-off of its entries.
   */
  template <int d>
  class OneContact
  {
  public:
    static constexpr int t = d - 1;

    OneContact(const double *A, const double mu) : mu_(mu)
    {
      double a[d * d], largest = 0.;
      for (int i = 0; i < d * d; ++i) {
        a[i] = A[i];
        largest = std::max(largest, std::abs(a[i]));
      }
      if (largest == 0.)
        largest = 1.;
      for (double shift = 0.;; shift = shift == 0. ? 1e-10 : 10. * shift) {
        for (int c = 0; c < d; ++c)
          a[(d + 1) * c] = A[(d + 1) * c] + shift * largest;
        if (a[0] > 1e-12 * largest && invert<d>(a, inverse_))
          break;
      }
      nn_ = a[0];
      for (int i = 0; i < t; ++i) {
        nt_[i] = a[1 + i];
        tn_[i] = a[d * (i + 1)];
        for (int j = 0; j < t; ++j)
          schur_[i][j] = a[d * (i + 1) + j + 1] - tn_[i] * a[1 + j] / nn_;
      }
      trace_ = 0.;
      for (int i = 0; i < t; ++i)
        trace_ += std::abs(schur_[i][i]);
      if (trace_ == 0.)
        trace_ = largest;
    }

    /** @p r: the solution; what was in it is a start for the root. */
    void solve(const double *b, double *r)
    {
      if (b[0] >= 0.) {
        std::fill(r, r + d, 0.);
        return;
      }
      multiply_vector<d>(inverse_, b, r);
      for (int c = 0; c < d; ++c)
        r[c] = -r[c];
      if (tangential_norm<d>(r) <= mu_ * r[0])
        return;
      if (mu_ == 0.) {
        std::fill(r, r + d, 0.);
        r[0] = -b[0] / nn_;
        return;
      }
      slide(b, r);
    }

  private:
    /** r_T and r_N at lambda. */
    void evaluate(const double lambda, const double *b, const double *c,
                  double *r, double *slope) const
    {
      double s[2] = {};
      if constexpr (d == 2) {
        r[1] = -c[0] / (schur_[0][0] + lambda);
        s[0] = -r[1] / (schur_[0][0] + lambda);
      } else {
        const double p = schur_[0][0] + lambda, q = schur_[1][1] + lambda;
        const double x = schur_[0][1], y = schur_[1][0];
        const double factor = 1. / (p * q - x * y);
        r[1] = -(q * c[0] - x * c[1]) * factor;
        r[2] = -(p * c[1] - y * c[0]) * factor;
        s[0] = -(q * r[1] - x * r[2]) * factor;
        s[1] = -(p * r[2] - y * r[1]) * factor;
      }
      r[0] = -b[0];
      double normal_slope = 0., norm_slope = 0.;
      for (int i = 0; i < t; ++i) {
        r[0] -= nt_[i] * r[1 + i];
        normal_slope -= nt_[i] * s[i];
        norm_slope += r[1 + i] * s[i];
      }
      r[0] /= nn_;
      slope[0] = mu_ * normal_slope / nn_;
      slope[1] = norm_slope; // of |r_T|^2 / 2
    }

    /** The root by Newton's method on 1/|r_T| - 1/(mu r_N), which is nearly
     * linear in lambda, kept inside a bracket. */
    void slide(const double *b, double *r)
    {
      double c[t];
      for (int i = 0; i < t; ++i)
        c[i] = b[1 + i] - tn_[i] * b[0] / nn_;
      double low = 0., high = std::numeric_limits<double>::infinity();
      double lambda = lambda_;
      for (int iteration = 0; iteration < 60; ++iteration) {
        double slope[2];
        evaluate(lambda, b, c, r, slope);
        const double norm = tangential_norm<d>(r), bound = mu_ * r[0];
        if (norm > bound)
          low = lambda;
        else
          high = lambda;
        if (std::abs(norm - bound) <= 4e-16 * norm)
          break;
        double next = -1.;
        if (bound > 0.) {
          const double value = 1. / norm - 1. / bound;
          const double derivative =
              -slope[1] / (norm * norm * norm) + slope[0] / (bound * bound);
          next = lambda - value / derivative;
        }
        if (!(next > low && next < high))
          next = std::isfinite(high) ? 0.5 * (low + high)
                                     : 2. * low + 0.1 * trace_;
        if (std::abs(next - lambda) <= 1e-16 * lambda || next == low ||
            next == high)
          break;
        lambda = next;
      }
      lambda_ = lambda;
      // on the cone to the last digit
      const double norm = tangential_norm<d>(r);
      if (r[0] < 0.)
        r[0] = 0.;
      if (norm > 0.)
        for (int i = 1; i < d; ++i)
          r[i] *= mu_ * r[0] / norm;
    }

    double mu_, nn_, nt_[t], tn_[t], schur_[t][t], inverse_[d * d];
    double trace_, lambda_ = 0.;
  };
} // namespace nsfd::stored
