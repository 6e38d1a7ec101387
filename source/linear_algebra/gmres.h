#pragma once

#include "krylov.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

/** The generalised minimal residual method: see krylov.h. */
namespace nsfd::krylov
{
  /** The solution of least residual in a space that grows by a vector. */
  class LeastResidual
  {
  public:
    explicit LeastResidual(const double residual) : g_{residual} {}

    double residual() const { return std::abs(g_.back()); }

    /** The next column of the Hessenberg matrix, which Givens rotations make
     * triangular. */
    void add(std::vector<double> column)
    {
      const std::size_t k = cosines_.size();
      for (std::size_t j = 0; j < k; ++j) {
        const double a = column[j], b = column[j + 1];
        column[j] = cosines_[j] * a + sines_[j] * b;
        column[j + 1] = -sines_[j] * a + cosines_[j] * b;
      }
      const double length = std::hypot(column[k], column[k + 1]);
      const double c = length > 0. ? column[k] / length : 1.,
                   s = length > 0. ? column[k + 1] / length : 0.;
      cosines_.push_back(c);
      sines_.push_back(s);
      column[k] = length;
      columns_.push_back(std::move(column));
      g_.push_back(-s * g_[k]);
      g_[k] *= c;
    }

    /** Coefficients of the basis, rounded to @p Number one after the other. */
    template <typename Number>
    std::vector<Number> solution() const
    {
      std::vector<Number> y(cosines_.size());
      for (std::size_t i = y.size(); i-- > 0;) {
        double value = g_[i];
        for (std::size_t j = i + 1; j < y.size(); ++j)
          value -= columns_[j][i] * y[j];
        y[i] = columns_[i][i] > 0. ? Number(value / columns_[i][i]) : Number(0);
      }
      return y;
    }

  private:
    std::vector<std::vector<double>> columns_;
    std::vector<double> g_, cosines_, sines_;
  };

  /**
   * GMRES for A x = b (Saad & Schultz, 1986), preconditioned from the right,
   * over a basis that @p basis holds:
   *
   *     using Number                       of the coefficients
   *     double start()                     v_0 = b / |b|; returns |b|
   *     double extend(k, double *h)        v_{k+1} = A B v_k, made orthogonal
   *                                        to v_j, j <= k, with products h[j],
   *                                        and of length one; its length before
   *     void combine(const vector<Number> &y)   x = sum of y_k B v_k
   */
  template <typename Basis>
  Outcome gmres(Basis &basis, const Limits &limits)
  {
    Outcome outcome;
    const double start = basis.start();
    LeastResidual least(start);
    unsigned int &k = outcome.iterations;
    while (k < limits.iterations &&
           least.residual() > limits.tolerance * start) {
      std::vector<double> column(k + 2, 0.);
      const double length = basis.extend(k, column.data());
      if (!std::isfinite(length))
        break;
      column[k + 1] = length;
      least.add(std::move(column));
      ++k;
      if (length == 0.)
        break;
    }
    outcome.converged = least.residual() <= limits.tolerance * start;
    if (start > 0.)
      outcome.reduction = least.residual() / start;
    basis.combine(least.template solution<typename Basis::Number>());
    return outcome;
  }

  /** @p sum += y_j v_j one after the other, four to a pass over it. */
  inline void add_vectors(const std::vector<std::vector<double>> &v,
                          const std::vector<double> &y,
                          std::vector<double> &sum)
  {
    std::size_t j = 0;
    for (; j + 4 <= y.size(); j += 4) {
      const double *a = v[j].data(), *b = v[j + 1].data(), *c = v[j + 2].data(),
                   *d = v[j + 3].data();
      for (std::size_t i = 0; i < sum.size(); ++i)
        sum[i] =
            (((sum[i] + y[j] * a[i]) + y[j + 1] * b[i]) + y[j + 2] * c[i]) +
            y[j + 3] * d[i];
    }
    for (; j < y.size(); ++j)
      for (std::size_t i = 0; i < sum.size(); ++i)
        sum[i] += y[j] * v[j][i];
  }

  /** What a basis of doubles keeps, and how orthogonal it is. */
  struct BasisOptions {
    /// B v_k are kept as well: for a preconditioner that is not the same
    /// twice, and to save its last application (flexible GMRES)
    bool flexible = false;
    /// of modified Gram-Schmidt; a second one where the first has lost digits
    unsigned int passes = 2;
  };

  /**
   * The basis of gmres() in vectors of doubles; functions as in CgSystem. Where
   * dot(a, v, n) returns a.v_j, j < n, and a.a, a column takes one sum.
   */
  template <typename Product, typename Preconditioner, typename Dot>
  class GmresBasis
  {
  public:
    using Number = double;
    using Vector = std::vector<double>;

    GmresBasis(const Product &product, const Preconditioner &preconditioner,
               const Dot &dot, const BasisOptions &options, Vector &x)
        : product_(product), preconditioner_(preconditioner), dot_(dot),
          options_(options), x_(x)
    {
    }

    double start()
    {
      v_.push_back(x_);
      const double length = std::sqrt(dot_(v_[0], v_[0]));
      normalise(v_[0], length);
      return length;
    }

    double extend(const unsigned int k, double *h)
    {
      if (options_.flexible || k == 0)
        z_.emplace_back(x_.size());
      Vector &z = z_.back();
      preconditioner_(v_[k], z);
      Vector next(x_.size());
      product_(z, next);
      const double length = orthogonalise(k, next, h);
      normalise(next, length);
      v_.push_back(std::move(next));
      return length;
    }

    void combine(const Vector &y)
    {
      Vector sum(x_.size(), 0.);
      add_vectors(options_.flexible ? z_ : v_, y, sum);
      if (options_.flexible)
        x_ = std::move(sum);
      else
        preconditioner_(sum, x_);
    }

  private:
    static void normalise(Vector &v, const double length)
    {
      if (length > 0.)
        for (double &value : v)
          value /= length;
    }

    /**
     * Classical Gram-Schmidt, again where digits were lost (Giraud et al.,
     * 2005): one sum for all products.
     */
    double orthogonalise_at_once(const unsigned int k, Vector &next,
                                 double *h) const
    {
      double length = 0.;
      for (unsigned int pass = 0; pass < 2; ++pass) {
        const std::vector<double> products = dot_(next, v_, k + 1);
        double left = products[k + 1];
        Vector shares(k + 1);
        for (unsigned int j = 0; j <= k; ++j) {
          h[j] += products[j];
          left -= products[j] * products[j];
          shares[j] = -products[j];
        }
        add_vectors(v_, shares, next);
        length = std::sqrt(std::max(0., left));
        if (length > 0.1 * std::sqrt(products[k + 1]))
          return length;
      }
      return std::sqrt(dot_(next, next));
    }

    double orthogonalise_one_by_one(const unsigned int k, Vector &next,
                                    double *h) const
    {
      double before = options_.passes > 1 ? std::sqrt(dot_(next, next)) : 0.,
             length = before;
      for (unsigned int pass = 0; pass < options_.passes; ++pass) {
        for (unsigned int j = 0; j <= k; ++j) {
          const double share = dot_(next, v_[j]);
          h[j] += share;
          for (std::size_t i = 0; i < next.size(); ++i)
            next[i] -= share * v_[j][i];
        }
        length = std::sqrt(dot_(next, next));
        if (length > 0.1 * before)
          break; // no digits were lost
        before = length;
      }
      return length;
    }

    double orthogonalise(const unsigned int k, Vector &next, double *h) const
    {
      if constexpr (std::is_invocable_v<Dot, const Vector &,
                                        const std::vector<Vector> &,
                                        unsigned int>)
        return orthogonalise_at_once(k, next, h);
      else
        return orthogonalise_one_by_one(k, next, h);
    }

    const Product &product_;
    const Preconditioner &preconditioner_;
    const Dot &dot_;
    const BasisOptions options_;
    std::vector<Vector> v_, z_;
    Vector &x_;
  };

  /** x = A^{-1} x. See CgSystem for the functions. */
  template <typename Product, typename Preconditioner, typename Dot>
  Outcome gmres(const Product &product, const Preconditioner &preconditioner,
                const Dot &dot, const Limits &limits,
                const BasisOptions &options, std::vector<double> &x)
  {
    GmresBasis<Product, Preconditioner, Dot> basis(product, preconditioner, dot,
                                                   options, x);
    return gmres(basis, limits);
  }

  /**
   * The basis of gmres() in the norm of its preconditioner, r.B r, with B
   * symmetric and positive definite: a residual is as large as the motion that
   * it asks for. Of a system with stiff rows the plain norm sees these alone,
   * and ends at their round-off. It takes no more applications of B.
   *
   *     sums(a, v, n)   a.v_j, j < n, and a.a
   *     sums(a, b)      a.b
   */
  template <typename Product, typename Preconditioner, typename Sums>
  class PreconditionedBasis
  {
  public:
    using Number = double;
    using Vector = std::vector<double>;

    PreconditionedBasis(const Product &product,
                        const Preconditioner &preconditioner, const Sums &sums,
                        Vector &x)
        : product_(product), preconditioner_(preconditioner), sums_(sums), x_(x)
    {
    }

    double start()
    {
      v_.push_back(x_);
      z_.emplace_back(x_.size());
      preconditioner_(v_[0], z_[0]);
      return normalise(sums_(v_[0], z_[0]));
    }

    double extend(const unsigned int k, double *h)
    {
      Vector next(x_.size()), z(x_.size());
      product_(z_[k], next);
      double before = orthogonalise(k, next, nullptr, h);
      preconditioner_(next, z);
      double square = sums_(next, z);
      before += square;
      if (square < lost * before) { // digits were lost
        orthogonalise(k, next, &z, h);
        square = sums_(next, z);
      }
      v_.push_back(std::move(next));
      z_.push_back(std::move(z));
      if (std::abs(square) <= round_off * before)
        square = 0.;
      return normalise(square);
    }

    void combine(const Vector &y)
    {
      std::fill(x_.begin(), x_.end(), 0.);
      add_vectors(z_, y, x_);
    }

  private:
    static constexpr double lost = 0.01, round_off = 1e-30; ///< of squares

    /** Of the last vectors; not a number if B is not positive definite. */
    double normalise(const double square)
    {
      const double length = std::sqrt(square);
      if (length > 0.)
        for (Vector *vector : {&v_.back(), &z_.back()})
          for (double &value : *vector)
            value /= length;
      return length;
    }

    /** Returns the squares that @p next has lost, and @p z, B next, with it. */
    double orthogonalise(const unsigned int k, Vector &next, Vector *z,
                         double *h) const
    {
      double squares = 0.;
      const Vector products = sums_(next, z_, k + 1);
      Vector shares(k + 1);
      for (unsigned int j = 0; j <= k; ++j) {
        h[j] += products[j];
        squares += products[j] * products[j];
        shares[j] = -products[j];
      }
      add_vectors(v_, shares, next);
      if (z)
        add_vectors(z_, shares, *z);
      return squares;
    }

    const Product &product_;
    const Preconditioner &preconditioner_;
    const Sums &sums_;
    std::vector<Vector> v_, z_; ///< z_k = B v_k
    Vector &x_;
  };

  /** x = A^{-1} x, the residual in the norm of the preconditioner. */
  template <typename Product, typename Preconditioner, typename Sums>
  Outcome gmres_preconditioned(const Product &product,
                               const Preconditioner &preconditioner,
                               const Sums &sums, const Limits &limits,
                               std::vector<double> &x)
  {
    PreconditionedBasis<Product, Preconditioner, Sums> basis(
        product, preconditioner, sums, x);
    return gmres(basis, limits);
  }
} // namespace nsfd::krylov
