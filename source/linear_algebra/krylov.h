#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

/**
 * The conjugate gradients and the generalised minimal residual method of all
 * linear systems that are solved by iterations. Scalar products are an
 * argument: where the sums do not depend on the number of ranks (Communicator),
 * neither do the iterations, which is why no library does this.
 */
namespace nsfd::krylov
{
  struct Limits {
    double tolerance = 0.; ///< of the residual, relative to its start
    unsigned int iterations = 0;
  };

  struct Outcome {
    unsigned int iterations = 0;
    bool converged = false;
  };

  /**
   * Preconditioned conjugate gradients for A x = b (Hestenes & Stiefel, 1952),
   * from the residual r that @p system holds, with its own vectors and sums:
   *
   *     bool is_solved()              by a criterion of its own
   *     double precondition()         z = B r; returns r.z
   *     void turn(double beta)        p = z + beta p, or p = z if beta is 0
   *     double multiply()             q = A p; returns p.q
   *     void advance(double alpha)    x += alpha p, r -= alpha q
   *
   * Ends when r.z is `tolerance`^2 of its first value, or where p.q is not
   * positive: round-off, or a matrix that is not positive definite.
   */
  template <typename System>
  Outcome conjugate_gradients(System &system, const Limits &limits)
  {
    Outcome outcome;
    double rz = 0., target = 0.;
    while (!system.is_solved()) {
      const double next = system.precondition();
      const bool first = outcome.iterations == 0;
      if (first)
        target = limits.tolerance * limits.tolerance * next;
      outcome.converged = next <= target;
      if (!(next > target) || outcome.iterations == limits.iterations)
        return outcome;
      system.turn(first ? 0. : next / rz);
      rz = next;
      const double curvature = system.multiply();
      if (!(curvature > 0.))
        return outcome;
      system.advance(rz / curvature);
      ++outcome.iterations;
    }
    outcome.converged = true;
    return outcome;
  }

  /** The vectors of an iteration, kept from one solve to the next. */
  struct CgVectors {
    std::vector<double> r, z, p, q;

    /** By @p alpha along p, from the iterate @p x. */
    void advance(const double alpha, std::vector<double> &x)
    {
      for (std::size_t k = 0; k < x.size(); ++k) {
        x[k] += alpha * p[k];
        r[k] -= alpha * q[k];
      }
    }
  };

  /**
   * The system of conjugate_gradients() on vectors of doubles:
   *
   *     product(p, q)         q = A p
   *     preconditioner(r, z)  z = B r
   *     dot(a, b)             a.b
   *     is_solved()           the criterion, asked for before z is computed
   */
  template <typename Product, typename Preconditioner, typename Dot,
            typename Criterion>
  class CgSystem
  {
  public:
    CgSystem(const Product &product, const Preconditioner &preconditioner,
             const Dot &dot, const Criterion &criterion, CgVectors &vectors,
             std::vector<double> &x)
        : product_(product), preconditioner_(preconditioner), dot_(dot),
          criterion_(criterion), v_(vectors), x_(x)
    {
    }

    bool is_solved() { return criterion_(); }

    double precondition()
    {
      preconditioner_(v_.r, v_.z);
      return dot_(v_.r, v_.z);
    }

    void turn(const double beta)
    {
      if (beta == 0.)
        v_.p = v_.z;
      else
        for (std::size_t k = 0; k < v_.p.size(); ++k)
          v_.p[k] = v_.z[k] + beta * v_.p[k];
    }

    double multiply()
    {
      product_(v_.p, v_.q);
      return dot_(v_.p, v_.q);
    }

    void advance(const double alpha) { v_.advance(alpha, x_); }

  private:
    const Product &product_;
    const Preconditioner &preconditioner_;
    const Dot &dot_;
    const Criterion &criterion_;
    CgVectors &v_;
    std::vector<double> &x_;
  };

  /**
   * The same with one sum per iteration (Chronopoulos & Gear, 1989): A is
   * applied to z and not to p, and
   *
   *     p.q = z.A z - beta^2 p_old.q_old.
   *
   *     sums(a, b, c)   a.b and b.c
   */
  template <typename Product, typename Preconditioner, typename Sums>
  class OneSumCgSystem
  {
  public:
    OneSumCgSystem(const Product &product, const Preconditioner &preconditioner,
                   const Sums &sums, CgVectors &vectors, std::vector<double> &x)
        : product_(product), preconditioner_(preconditioner), sums_(sums),
          v_(vectors), x_(x), w_(x.size())
    {
    }

    bool is_solved() const { return false; }

    double precondition()
    {
      preconditioner_(v_.r, v_.z);
      product_(v_.z, w_);
      const std::array<double, 2> both = sums_(v_.r, v_.z, w_);
      energy_ = both[1];
      return both[0];
    }

    void turn(const double beta)
    {
      if (beta == 0.) {
        v_.p = v_.z;
        v_.q = w_;
      } else
        for (std::size_t k = 0; k < v_.p.size(); ++k) {
          v_.p[k] = v_.z[k] + beta * v_.p[k];
          v_.q[k] = w_[k] + beta * v_.q[k];
        }
      curvature_ = energy_ - beta * beta * curvature_;
    }

    double multiply() const { return curvature_; }

    void advance(const double alpha) { v_.advance(alpha, x_); }

  private:
    const Product &product_;
    const Preconditioner &preconditioner_;
    const Sums &sums_;
    CgVectors &v_;
    std::vector<double> &x_;
    std::vector<double> w_; ///< A z
    double energy_ = 0., curvature_ = 0.;
  };

  /**
   * Adds to @p x the solution of A dx = r, r in @p vectors, which are of the
   * size of x. See CgSystem for the functions.
   */
  template <typename Product, typename Preconditioner, typename Dot,
            typename Criterion>
  Outcome conjugate_gradients(const Product &product,
                              const Preconditioner &preconditioner,
                              const Dot &dot, const Criterion &criterion,
                              const Limits &limits, CgVectors &vectors,
                              std::vector<double> &x)
  {
    CgSystem<Product, Preconditioner, Dot, Criterion> system(
        product, preconditioner, dot, criterion, vectors, x);
    return conjugate_gradients(system, limits);
  }

  template <typename Product, typename Preconditioner, typename Dot>
  Outcome conjugate_gradients(const Product &product,
                              const Preconditioner &preconditioner,
                              const Dot &dot, const Limits &limits,
                              CgVectors &vectors, std::vector<double> &x)
  {
    return conjugate_gradients(
        product, preconditioner, dot, [] { return false; }, limits, vectors, x);
  }

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
    basis.combine(least.template solution<typename Basis::Number>());
    return outcome;
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
      const auto &terms = options_.flexible ? z_ : v_;
      for (std::size_t j = 0; j < y.size(); ++j)
        for (std::size_t i = 0; i < sum.size(); ++i)
          sum[i] += y[j] * terms[j][i];
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
        for (unsigned int j = 0; j <= k; ++j) {
          h[j] += products[j];
          left -= products[j] * products[j];
          for (std::size_t i = 0; i < next.size(); ++i)
            next[i] -= products[j] * v_[j][i];
        }
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
} // namespace nsfd::krylov
