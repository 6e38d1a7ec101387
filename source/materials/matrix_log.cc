#include "matrix_log.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  using namespace space;

  namespace
  {
    /** (ln b - ln a) / (b - a), 1 / a for equal ones. */
    double log_difference(const double a, const double b)
    {
      const double z = (b - a) / (b + a);
      return (z == 0. ? 1. : std::atanh(z) / z) * 2. / (a + b);
    }

    /**
     * Less the second divided difference of ln, int 1 / ((a + t) (b + t)
     * (c + t)) dt. Near to each other, over their mean m, by the series
     * sum (-1)^n h_n(u) / (n + 2) of the complete symmetric polynomials of
     * u = a / m - 1, ..., whose sum vanishes.
     */
    double second_log_difference(double a, double b, double c)
    {
      constexpr double near = 1.15;
      constexpr unsigned int n_terms = 16;
      if (a > b)
        std::swap(a, b);
      if (b > c)
        std::swap(b, c);
      if (a > b)
        std::swap(a, b);
      if (c > near * a)
        return (log_difference(a, b) - log_difference(b, c)) / (c - a);
      const double m = (a + b + c) / 3., u = (a - m) / m, v = (b - m) / m,
                   w = (c - m) / m;
      const double e2 = u * v + v * w + w * u, e3 = u * v * w;
      double h[n_terms] = {1., 0., -e2}, result = 0.5 - e2 / 4.;
      for (unsigned int n = 3; n < n_terms; ++n) {
        h[n] = -e2 * h[n - 2] + e3 * h[n - 3];
        result += (n % 2 ? -h[n] : h[n]) / (n + 2.);
      }
      return result / (m * m);
    }
  } // namespace

  Mat3 matrix(const Voigt<3> &A)
  {
    return {{{A[0], A[3], A[4]}, {A[3], A[1], A[5]}, {A[4], A[5], A[2]}}};
  }

  Voigt<3> entries(const Mat3 &A)
  {
    return {A[0][0],
            A[1][1],
            A[2][2],
            (A[0][1] + A[1][0]) / 2.,
            (A[0][2] + A[2][0]) / 2.,
            (A[1][2] + A[2][1]) / 2.};
  }

  Spectrum::Spectrum(const Voigt<3> &given)
      : vectors_{{{1., 0., 0.}, {0., 1., 0.}, {0., 0., 1.}}}
  {
    constexpr unsigned int most_sweeps = 50;
    Mat3 A = matrix(given);
    for (unsigned int sweep = 0; sweep < most_sweeps; ++sweep) {
      bool turned = false;
      for (unsigned int p = 0; p < 2; ++p)
        for (unsigned int q = p + 1; q < 3; ++q) {
          // what does not change the diagonal is zero
          const double off = A[p][q];
          const double t_half = (A[q][q] - A[p][p]) / (2. * off);
          const double t = (t_half < 0. ? -1. : 1.) /
                           (std::abs(t_half) + std::sqrt(1. + t_half * t_half));
          if (off == 0. || (A[p][p] - t * off == A[p][p] &&
                            A[q][q] + t * off == A[q][q] && sweep > 3)) {
            A[p][q] = A[q][p] = 0.;
            continue;
          }
          turned = true;
          const double c = 1. / std::sqrt(1. + t * t), s = t * c;
          A[p][p] -= t * off;
          A[q][q] += t * off;
          A[p][q] = A[q][p] = 0.;
          const unsigned int r = 3 - p - q;
          const double rp = A[r][p], rq = A[r][q];
          A[r][p] = A[p][r] = c * rp - s * rq;
          A[r][q] = A[q][r] = s * rp + c * rq;
          for (unsigned int k = 0; k < 3; ++k) {
            const double vp = vectors_[k][p], vq = vectors_[k][q];
            vectors_[k][p] = c * vp - s * vq;
            vectors_[k][q] = s * vp + c * vq;
          }
        }
      if (!turned)
        break;
    }
    for (unsigned int k = 0; k < 3; ++k)
      values_[k] = A[k][k];
  }

  Voigt<3> Spectrum::with_values(const Vec3 &f) const
  {
    Mat3 scaled = vectors_;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int k = 0; k < 3; ++k)
        scaled[i][k] *= f[k];
    return entries(scaled * transposed(vectors_));
  }

  Voigt<3> Spectrum::half_log() const
  {
    return function([](const double c) { return std::log(c) / 2.; });
  }

  Voigt<3> half_log_change(const Spectrum &C, const Voigt<3> &H)
  {
    const Mat3 &B = C.vectors();
    Mat3 K = transposed(B) * (matrix(H) * B);
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        K[i][j] *= log_difference(C.values()[i], C.values()[j]) / 2.;
    return entries(B * (K * transposed(B)));
  }

  LogSecant::LogSecant(const Spectrum &start, const Spectrum &end)
      : start_(start), end_(end)
  {
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        differences_[i][j] = log_difference(start.values()[i], end.values()[j]);
  }

  /** The symmetric part of A W B^T. */
  Voigt<3> LogSecant::from_bases(const Mat3 &W) const
  {
    return entries(start_.vectors() * (W * transposed(end_.vectors())));
  }

  Voigt<3> LogSecant::pulled_back(const Voigt<3> &T) const
  {
    Mat3 W = transposed(start_.vectors()) * (matrix(T) * end_.vectors());
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        W[i][j] *= differences_[i][j];
    return from_bases(W);
  }

  LogSecant::EndDerivative::EndDerivative(const LogSecant &secant,
                                          const Voigt<3> &T)
      : secant_(secant)
  {
    const Mat3 W = transposed(secant.start_.vectors()) *
                   (matrix(T) * secant.end_.vectors());
    const Vec3 &a = secant.start_.values(), &b = secant.end_.values();
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        for (unsigned int k = 0; k <= j; ++k) {
          const double second = second_log_difference(a[i], b[j], b[k]);
          differences_[i][j][k] = second * W[i][j];
          differences_[i][k][j] = second * W[i][k];
        }
  }

  Voigt<3> LogSecant::EndDerivative::operator()(const Voigt<3> &H) const
  {
    const Mat3 &B = secant_.end_.vectors();
    const Mat3 K = transposed(B) * (matrix(H) * B);
    Mat3 change{};
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        for (unsigned int k = 0; k < 3; ++k)
          change[i][k] -= differences_[i][j][k] * K[j][k];
    return secant_.from_bases(change);
  }
} // namespace nsfd
