#include "contact_cone.h"
#include "linear_algebra/small_matrix.h"
#include "session.h"

#include <limits>

namespace nsfd::stored
{
  namespace
  {
    /** One path of the interior point: r, u and the slack z of u_N apart. */
    template <int d>
    class Path
    {
    public:
      Path(Session<d> &session, const std::vector<double> &scale,
           const double start)
          : s_(session), p_(session.problem), scale_(scale), r_(session.r),
            u_(session.u), z_(p_.n), A_(std::size_t(d * d) * p_.n), B_(A_),
            k_(r_.size()), x_(r_.size()), w_(r_.size()), g_(r_.size())
      {
        double mean = 0.;
        for (int i = 0; i < p_.n; ++i)
          mean += r_[d * i];
        mean_ = std::max(mean / p_.n, 1e-12);
        for (int i = 0; i < p_.n; ++i) {
          const double R = 1. / p_.diagonal_block(i)[0];
          const double R_ok = R > 0. && std::isfinite(R) ? R : 1.;
          const double y = r_[d * i] - R_ok * u_[d * i];
          const double shift = 2. * start * mean_ * scale_[i];
          const double root = std::sqrt(y * y + shift * shift);
          r_[d * i] = 0.5 * (root + y);
          z_[i] = 0.5 * (root - y) / R_ok;
          // far from zero the difference of two large numbers
          if (y > 0.)
            z_[i] = 0.5 * shift * shift / (root + y) / R_ok;
          else
            r_[d * i] = 0.5 * shift * shift / (root - y);
          clip(i);
        }
      }

      double gap() const
      {
        double sum = 0.;
        for (int i = 0; i < p_.n; ++i)
          sum += z_[i] * r_[d * i] / (scale_[i] * scale_[i]);
        return sum / p_.n;
      }

      /** One Newton step. @return its length */
      double advance()
      {
        const double sigma = alpha_ > 0.9   ? 0.1
                             : alpha_ > 0.5 ? 0.3
                             : alpha_ > 0.1 ? 0.6
                                            : 1.;
        const double gap_now = gap();
        linearise(sigma * gap_now, gap_now / mean_);
        s_.factor(A_, B_);
        s_.solve(x_);
        p_.multiply(x_.data(), w_.data());
        s_.count_products(1);
        ++s_.iterations;
        alpha_ = 1.;
        for (int i = 0; i < p_.n; ++i) {
          const double dz = u_[d * i] + w_[d * i] + g_[d * i] - z_[i];
          if (x_[d * i] < 0.)
            alpha_ = std::min(alpha_, -0.99 * r_[d * i] / x_[d * i]);
          if (dz < 0.)
            alpha_ = std::min(alpha_, -0.99 * z_[i] / dz);
        }
        if (!(alpha_ > 0.) || !std::isfinite(alpha_))
          return 0.;
        for (int i = 0; i < p_.n; ++i) {
          z_[i] += alpha_ * (u_[d * i] + w_[d * i] + g_[d * i] - z_[i]);
          for (int c = 0; c < d; ++c) {
            r_[d * i + c] += alpha_ * x_[d * i + c];
            u_[d * i + c] += alpha_ * (w_[d * i + c] + g_[d * i + c]);
          }
          clip(i);
        }
        return alpha_;
      }

      const std::vector<double> &impulse() const { return r_; }
      double mean() const { return mean_; }

    private:
      void clip(const int i)
      {
        const double t = tangential_norm<d>(&r_[d * i]);
        const double bound = p_.mu[i] * r_[d * i];
        if (t > bound)
          for (int c = 1; c < d; ++c)
            r_[d * i + c] *= bound / t;
      }

      /** Rows (I + S W) dr = k - S g, divided by I + S so that no entry grows
       * where S does. */
      void linearise(const double eps, const double delta)
      {
        p_.velocity(r_.data(), g_.data());
        s_.count_products(1);
        s_.charge(20. * p_.n);
        for (std::size_t j = 0; j < g_.size(); ++j)
          g_[j] -= u_[j];
        for (int i = 0; i < p_.n; ++i) {
          const double *r = &r_[d * i], *u = &u_[d * i];
          const double mu = p_.mu[i], s = scale_[i];
          double S[d * d] = {}, k[d];
          double eta = delta * s * delta * s;
          for (int c = 1; c < d; ++c)
            eta += u[c] * u[c];
          eta = std::sqrt(eta);
          S[0] = r[0] / z_[i];
          k[0] = (eps * s * s - z_[i] * r[0]) / z_[i] + S[0] * (z_[i] - u[0]);
          for (int c = 1; c < d; ++c) {
            S[d * c] = -mu * u[c] / eta * S[0];
            for (int e = 1; e < d; ++e)
              S[d * c + e] = r[c] * u[e] / (eta * eta);
            S[(d + 1) * c] += mu * r[0] / eta;
            k[c] = -r[c] - mu * r[0] * u[c] / eta - mu * u[c] / eta * k[0];
          }
          double sum[d * d], *A = &A_[d * d * i], *B = &B_[d * d * i];
          for (int c = 0; c < d * d; ++c)
            sum[c] = S[c] + (c % (d + 1) == 0 ? 1. : 0.);
          invert<d>(sum, A);
          for (int c = 0; c < d * d; ++c)
            B[c] = (c % (d + 1) == 0 ? 1. : 0.) - A[c];
          double a[d], b[d];
          multiply_vector<d>(A, k, a);
          multiply_vector<d>(B, &g_[d * i], b);
          for (int c = 0; c < d; ++c)
            x_[d * i + c] = a[c] - b[c];
        }
      }

      Session<d> &s_;
      const BlockProblem<d> &p_;
      const std::vector<double> &scale_;
      std::vector<double> r_, u_, z_, A_, B_, k_, x_, w_, g_;
      double mean_ = 1., alpha_ = 0.;
    };

    template <int d>
    std::vector<double> local_scales(const Session<d> &s, const double mean,
                                     const double floor)
    {
      std::vector<double> scale(s.problem.n);
      for (int i = 0; i < s.problem.n; ++i) {
        double r2 = 0., u2 = 0.;
        for (int c = 0; c < d; ++c) {
          r2 += s.r[d * i + c] * s.r[d * i + c];
          u2 += s.u[d * i + c] * s.u[d * i + c];
        }
        scale[i] = std::max(std::sqrt(r2 + u2) / mean, floor);
      }
      return scale;
    }
  } // namespace

  template <int d>
  bool interior_point(Session<d> &s, const unsigned int limit)
  {
    struct Stage {
      double floor, start;
    };
    const Stage stages[] = {{0., 1.}, {1e-3, 3e-3}, {1e-5, 3e-4}};
    Best<d> best(s);
    double refined = std::numeric_limits<double>::infinity(), mean = 1.;
    unsigned int k = 0;
    for (const Stage &stage : stages) {
      std::vector<double> scale(s.problem.n, 1.);
      if (stage.floor > 0.) {
        admm(s, 20);
        best.keep();
        scale = local_scales(s, mean, stage.floor);
      }
      Path<d> path(s, scale, stage.start);
      mean = path.mean();
      const double first_gap = path.gap();
      for (unsigned int short_steps = 0;
           short_steps < 5 && !s.solved() && k < limit &&
           path.gap() > 1e-14 * first_gap;
           ++k) {
        const double length = path.advance();
        s.r = path.impulse();
        s.judge();
        if (length == 0. || !std::isfinite(s.error))
          break;
        best.keep();
        if (s.error < 1e-4 && s.error < 0.1 * refined) {
          refined = s.error;
          NewtonSettings settings;
          settings.limit = 4;
          newton(s, settings);
          best.keep();
        }
        short_steps = length < 0.05 ? short_steps + 1 : 0;
      }
      best.restore();
      if (s.solved())
        break;
    }
    return s.solved();
  }

  template bool interior_point<2>(Session<2> &, unsigned int);
  template bool interior_point<3>(Session<3> &, unsigned int);
} // namespace nsfd::stored
