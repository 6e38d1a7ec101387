#include "contact_cone.h"
#include "session.h"

namespace nsfd::stored
{
  /** Accelerated projected gradient with the De Saxce term of the last point,
   *
   *     r <- P_K( y - (u(y) + mu |u_T| e_N) / L ),
   *
   * Nesterov's momentum, restarted where the error rises, L by backtracking
   * on the curvature of W along the step. */
  template <int d>
  bool projected_gradient(Session<d> &s, const unsigned int limit)
  {
    const BlockProblem<d> &p = s.problem;
    const std::size_t n = s.r.size();
    std::vector<double> y = s.r, r = s.r, last(n), u(n), change(n), v(n);
    Best<d> best(s);
    double L = 1., momentum = 1., before = s.error;
    for (unsigned int k = 0; k < limit && !s.solved(); ++k) {
      p.velocity(y.data(), u.data());
      s.count_products(1);
      last = r;
      for (;;) {
        for (int i = 0; i < p.n; ++i) {
          double x[d];
          for (int c = 0; c < d; ++c)
            x[c] = y[d * i + c] - u[d * i + c] / L;
          x[0] -= p.mu[i] * tangential_norm<d>(&u[d * i]) / L;
          const auto z = project_on_cone<d>(x, p.mu[i]);
          std::copy(z.begin(), z.end(), &r[d * i]);
        }
        for (std::size_t j = 0; j < n; ++j)
          change[j] = r[j] - y[j];
        p.multiply(change.data(), v.data());
        s.count_products(1);
        double curvature = 0., square = 0.;
        for (std::size_t j = 0; j < n; ++j) {
          curvature += change[j] * v[j];
          square += change[j] * change[j];
        }
        if (!(curvature > L * square))
          break;
        L *= 1.5;
      }
      ++s.iterations;
      s.r = r;
      for (std::size_t j = 0; j < n; ++j)
        s.u[j] = u[j] + v[j];
      s.error = p.error(s.r.data(), s.u.data());
      best.keep();
      const bool restart = s.error > before;
      before = s.error;
      const double next =
          restart ? 1. : 0.5 * (1. + std::sqrt(1. + 4. * momentum * momentum));
      const double weight = restart ? 0. : (momentum - 1.) / next;
      momentum = next;
      for (std::size_t j = 0; j < n; ++j)
        y[j] = r[j] + weight * (r[j] - last[j]);
    }
    best.restore();
    return s.solved();
  }

  template bool projected_gradient<2>(Session<2> &, unsigned int);
  template bool projected_gradient<3>(Session<3> &, unsigned int);
} // namespace nsfd::stored
