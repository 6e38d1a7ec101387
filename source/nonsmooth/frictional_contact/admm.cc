#include "contact_cone.h"
#include "session.h"

namespace nsfd::stored
{
  namespace
  {
    /** The penalty that makes multiplier and impulse equally large, inside the
     * range in which it is any good: W has its diagonal near 1. */
    template <int d>
    double balanced_penalty(const Session<d> &s)
    {
      double impulses = 0., velocities = 0.;
      for (int i = 0; i < s.problem.n; ++i)
        for (int c = 0; c < d; ++c) {
          const double u =
              s.u[d * i + c] +
              (c == 0 ? s.problem.mu[i] * tangential_norm<d>(&s.u[d * i]) : 0.);
          velocities += u * u;
          impulses += s.r[d * i + c] * s.r[d * i + c];
        }
      return impulses > 0.
                 ? std::clamp(std::sqrt(velocities / impulses), 0.05, 1.)
                 : 1.;
    }
  } // namespace

  /** Alternating directions for r = z, r in the linear part, z in the cone:
   *
   *     (W + R) r = R (z - y) - q - s,   z = P_K(r + y),   y <- y + r - z,
   *
   * R y the multiplier, -R y = u^ at the solution, s = mu |u_T| e_N the De
   * Saxce term from the last y. One factor as long as R rests. */
  template <int d>
  bool admm(Session<d> &s, const unsigned int limit)
  {
    constexpr int area = d * d;
    const BlockProblem<d> &p = s.problem;
    const std::size_t n = s.r.size();
    std::vector<double> A(std::size_t(area) * p.n), B(A.size()), R(p.n), y(n),
        z = s.r, x(n);
    double penalty = balanced_penalty(s);
    const auto set_penalty = [&] {
      for (int i = 0; i < p.n; ++i)
        for (int c = 0; c < d; ++c) {
          A[std::size_t(area) * i + (d + 1) * c] = R[i] = penalty;
          B[std::size_t(area) * i + (d + 1) * c] = 1.;
        }
      s.factor(A, B);
    };
    set_penalty();
    for (int i = 0; i < p.n; ++i) {
      const double t = tangential_norm<d>(&s.u[d * i]);
      y[d * i] = -(s.u[d * i] + p.mu[i] * t) / R[i];
      for (int c = 1; c < d; ++c)
        y[d * i + c] = -s.u[d * i + c] / R[i];
    }
    const double relaxation = 1.6;
    unsigned int next_balance = 20;
    for (unsigned int k = 1; k <= limit && !s.solved(); ++k) {
      for (int i = 0; i < p.n; ++i) {
        const int a = d * i;
        const double slip = p.mu[i] * R[i] * tangential_norm<d>(&y[a]);
        for (int c = 0; c < d; ++c)
          x[a + c] = R[i] * (z[a + c] - y[a + c]) - p.q[a + c];
        x[a] -= slip;
      }
      s.solve(x);
      ++s.products;
      ++s.iterations;
      for (int i = 0; i < p.n; ++i) {
        const int a = d * i;
        double w[d];
        for (int c = 0; c < d; ++c)
          w[c] =
              relaxation * x[a + c] + (1. - relaxation) * z[a + c] + y[a + c];
        const auto next = project_on_cone<d>(w, p.mu[i]);
        for (int c = 0; c < d; ++c) {
          y[a + c] = w[c] - next[c];
          z[a + c] = next[c];
        }
      }
      if (k % 5 == 0 || k == limit) {
        s.r = z;
        s.judge();
      }
      if (k == next_balance && k + 20 < limit) {
        next_balance *= 4;
        const double factor = balanced_penalty(s) / penalty;
        if (factor > 3. || factor < 1. / 3.) {
          penalty *= factor;
          for (double &value : y)
            value /= factor;
          set_penalty();
        }
      }
    }
    return s.solved();
  }

  template bool admm<2>(Session<2> &, unsigned int);
  template bool admm<3>(Session<3> &, unsigned int);
} // namespace nsfd::stored
