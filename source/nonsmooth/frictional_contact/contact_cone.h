#pragma once

#include <algorithm>
#include <array>
#include <cmath>

/** Geometry of one contact; all vectors have the normal component first. */
namespace nsfd::stored
{
  template <int d>
  double tangential_norm(const double *x)
  {
    if constexpr (d == 2)
      return std::abs(x[1]);
    else
      return std::sqrt(x[1] * x[1] + x[2] * x[2]);
  }

  /** P_K x, the nearest point of { |y_T| <= mu y_N }. */
  template <int d>
  std::array<double, d> project_on_cone(const double *x, const double mu)
  {
    std::array<double, d> y{};
    const double t = tangential_norm<d>(x);
    if (mu * t <= -x[0])
      return y;
    if (t <= mu * x[0]) {
      std::copy(x, x + d, y.begin());
      return y;
    }
    y[0] = (x[0] + mu * t) / (1. + mu * mu);
    for (int c = 1; c < d; ++c)
      y[c] = mu * y[0] * x[c] / t;
    return y;
  }

  /** |r - P_K(r - u^)|^2 of one contact. */
  template <int d>
  double squared_natural_map(const double *r, const double *u, const double mu)
  {
    double x[d];
    x[0] = r[0] - u[0] - mu * tangential_norm<d>(u);
    for (int c = 1; c < d; ++c)
      x[c] = r[c] - u[c];
    const std::array<double, d> y = project_on_cone<d>(x, mu);
    double sum = 0.;
    for (int c = 0; c < d; ++c)
      sum += (r[c] - y[c]) * (r[c] - y[c]);
    return sum;
  }
} // namespace nsfd::stored
