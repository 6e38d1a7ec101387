#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

/**
 * The conjugate gradients and, in gmres.h, the generalised minimal residual
 * method of all linear systems that are solved by iterations. Scalar products
 * are an argument: where the sums do not depend on the number of ranks
 * (Communicator), neither do the iterations, which is why no library does this.
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
    double reduction = 1.; ///< of the residual, as it was seen last
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
    double rz = 0., start = 0., target = 0.;
    while (!system.is_solved()) {
      const double next = system.precondition();
      const bool first = outcome.iterations == 0;
      if (first) {
        start = next;
        target = limits.tolerance * limits.tolerance * next;
      } else
        outcome.reduction = std::sqrt(std::abs(next / start));
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
} // namespace nsfd::krylov
