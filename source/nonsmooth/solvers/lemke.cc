#include "lemke.h"

#include "core/stop_request.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace nsfd
{
  namespace
  {
    /**
     * w = M z + q + z_0 d, w, z >= 0, w z = 0, as a dictionary of the basic
     * variables. Variables: w_i is i, z_i is n + i, z_0 is 2 n.
     */
    class Lemke
    {
    public:
      Lemke(std::vector<double> M, std::vector<double> q, const unsigned seed)
          : n_(q.size()), columns_(n_ + 2), table_(n_ * columns_), basic_(n_),
            cobasic_(n_ + 1)
      {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> share(1., 2.);
        for (std::size_t i = 0; i < n_; ++i) {
          for (std::size_t j = 0; j < n_; ++j)
            at(i, j) = M[i * n_ + j];
          at(i, n_) = share(random);
          at(i, n_ + 1) = q[i];
          basic_[i] = i;
          cobasic_[i] = n_ + i;
        }
        cobasic_[n_] = 2 * n_;
      }

      bool solve(std::vector<double> &z)
      {
        std::size_t row = n_;
        double worst = 0.;
        for (std::size_t i = 0; i < n_; ++i)
          if (at(i, n_ + 1) / at(i, n_) < worst) {
            worst = at(i, n_ + 1) / at(i, n_);
            row = i;
          }
        if (row < n_) {
          std::size_t column = n_;
          for (unsigned int k = 0;; ++k) {
            if (k == 50 + 20 * n_)
              return false;
            stop_request::leave_if_due();
            const std::size_t left = basic_[row];
            pivot(row, column);
            if (left == 2 * n_)
              break;
            // the partner of the variable that left comes in
            const std::size_t enters = left < n_ ? left + n_ : left - n_;
            column = std::find(cobasic_.begin(), cobasic_.end(), enters) -
                     cobasic_.begin();
            row = ratio(column);
            if (row == n_)
              return false; // a ray
          }
        }
        z.assign(n_, 0.);
        for (std::size_t i = 0; i < n_; ++i)
          if (basic_[i] >= n_ && basic_[i] < 2 * n_)
            z[basic_[i] - n_] = at(i, n_ + 1);
        return true;
      }

    private:
      double &at(const std::size_t i, const std::size_t j)
      {
        return table_[i * columns_ + j];
      }

      /** The row that first comes to zero; of equal ones the largest pivot,
       *  and z_0 before all. */
      std::size_t ratio(const std::size_t column)
      {
        double largest = 0.;
        for (std::size_t i = 0; i < n_; ++i)
          largest = std::max(largest, std::abs(at(i, column)));
        const double small = 1e-11 * largest;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < n_; ++i)
          if (at(i, column) < -small)
            least = std::min(least,
                             (std::max(at(i, n_ + 1), 0.) + 1e-13 * scale()) /
                                 -at(i, column));
        std::size_t row = n_;
        double best = 0.;
        for (std::size_t i = 0; i < n_; ++i)
          if (at(i, column) < -small &&
              std::max(at(i, n_ + 1), 0.) / -at(i, column) <= least) {
            if (basic_[i] == 2 * n_)
              return i;
            if (-at(i, column) > best) {
              best = -at(i, column);
              row = i;
            }
          }
        return row;
      }

      double scale()
      {
        double largest = 0.;
        for (std::size_t i = 0; i < n_; ++i)
          largest = std::max(largest, std::abs(at(i, n_ + 1)));
        return largest;
      }

      /** basic_[row] = sum_j a_j x_j + b solved for the variable of a column.
       */
      void pivot(const std::size_t row, const std::size_t column)
      {
        const double inverse = 1. / at(row, column);
        for (std::size_t j = 0; j < columns_; ++j)
          at(row, j) *= -inverse;
        at(row, column) = inverse;
        for (std::size_t i = 0; i < n_; ++i) {
          const double factor = at(i, column);
          if (i == row || factor == 0.)
            continue;
          for (std::size_t j = 0; j < columns_; ++j)
            at(i, j) = (j == column ? 0. : at(i, j)) + factor * at(row, j);
        }
        std::swap(basic_[row], cobasic_[column]);
      }

      std::size_t n_, columns_;
      std::vector<double> table_;
      std::vector<std::size_t> basic_, cobasic_;
    };
  } // namespace

  /**
   * With a = mu r_N + r_T and b = mu r_N - r_T, u_T = u+ - u-, the rows are
   *
   *     (u_N, u+, b) = M (r_N, a, u-) + (q_N, q_T, 0),   r_T = a - mu r_N.
   */
  bool solve_by_lemke(const std::vector<double> &W,
                      const std::vector<double> &q,
                      const std::vector<double> &friction,
                      const unsigned int seed, std::vector<double> &r)
  {
    const std::size_t m = friction.size(), n = 3 * m;
    // units: the mean diagonal of W and the largest velocity
    double compliance = 0., velocity = 0.;
    for (std::size_t k = 0; k < 2 * m; ++k) {
      compliance += W[k * 2 * m + k] / double(2 * m);
      velocity = std::max(velocity, std::abs(q[k]));
    }
    if (!(compliance > 0.) || !(velocity > 0.))
      return false;
    std::vector<double> M(n * n, 0.), b(n, 0.), z;
    for (std::size_t i = 0; i < m; ++i) {
      for (std::size_t c = 0; c < 2; ++c) {
        double *row = &M[(c * m + i) * n];
        for (std::size_t j = 0; j < m; ++j) {
          const double normal = W[(2 * i + c) * 2 * m + 2 * j] / compliance,
                       tangential =
                           W[(2 * i + c) * 2 * m + 2 * j + 1] / compliance;
          row[j] = normal - friction[j] * tangential;
          row[m + j] = tangential;
        }
        b[c * m + i] = q[2 * i + c] / velocity;
      }
      M[(m + i) * n + 2 * m + i] = 1.;
      M[(2 * m + i) * n + i] = 2. * friction[i];
      M[(2 * m + i) * n + m + i] = -1.;
    }
    if (!Lemke(M, b, seed).solve(z))
      return false;
    r.resize(2 * m);
    for (std::size_t i = 0; i < m; ++i) {
      r[2 * i] = z[i] * velocity / compliance;
      r[2 * i + 1] = (z[m + i] - friction[i] * z[i]) * velocity / compliance;
    }
    return true;
  }
} // namespace nsfd
