#include "isotropic_hardening.h"

#include "nsfd/scene/material_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace nsfd
{
  IsotropicHardening::IsotropicHardening(const double young,
                                         const PlasticInput &plastic)
      : yield_(plastic.yield_stress), yield_strain_(yield_ / young),
        linear_(plastic.isotropic), saturation_(plastic.saturation_stress),
        decay_(plastic.saturation_exponent)
  {
    if (plastic.hardening_exponent > 0.)
      inverse_ = 1. / plastic.hardening_exponent;
  }

  // t = s - 1 of s^m = s + x from Newton's steps for m log s = log(s + x), both
  // sides of which are nearly straight. They begin on the left of the root, at
  // s^m = 1 + x, and as the difference is concave none of them passes it.
  double IsotropicHardening::excess(const double p) const
  {
    constexpr double round_off = std::numeric_limits<double>::epsilon();
    const double m = inverse_, x = p / yield_strain_;
    if (!(x > 0.))
      return 0.;
    double t = std::expm1(std::log1p(x) / m),
           last = std::numeric_limits<double>::infinity();
    for (;;) {
      const double change = (std::log1p(x + t) - m * std::log1p(t)) /
                            (m / (1. + t) - 1. / (1. + x + t));
      t += change;
      // the last digits come and go
      if (!(std::abs(change) > 2. * round_off * t) ||
          !(std::abs(change) < last))
        return std::max(0., t);
      last = std::abs(change);
    }
  }

  // The mean of t = s - 1 over the flow dp = yield/E (m s^(m - 1) - 1) ds from
  // t0 to t1. Over short ways the closed form loses digits, and the rule of
  // five points loses none if the flow is summed by it as well.
  double IsotropicHardening::mean_excess(const double t0, const double t1) const
  {
    constexpr std::array<std::array<double, 2>, 5> rule{
        {{0., 0.56888888888888889},
         {-0.53846931010568309, 0.47862867049936647},
         {0.53846931010568309, 0.47862867049936647},
         {-0.90617984593866399, 0.23692688505618909},
         {0.90617984593866399, 0.23692688505618909}}};
    constexpr double short_way = 0.5; // in units of the growth of s^m
    const double m = inverse_;
    if (m * (t1 - t0) < short_way * (1. + t0)) {
      double sum = 0., flow = 0.;
      for (const auto &[place, weight] : rule) {
        const double t = (t0 + t1) / 2. + (t1 - t0) / 2. * place;
        const double rate =
            weight * (m * std::exp((m - 1.) * std::log1p(t)) - 1.);
        sum += rate * t;
        flow += rate;
      }
      return sum / flow;
    }
    const auto integrals = [m](const double t) { // of t and of 1
      const double power = std::expm1(m * std::log1p(t));
      return std::array<double, 2>{m / (m + 1.) * (power + t * (1. + power)) -
                                       t * t / 2. - power,
                                   power - t};
    };
    const auto from = integrals(t0), to = integrals(t1);
    return (to[0] - from[0]) / (to[1] - from[1]);
  }

  IsotropicHardening::Value IsotropicHardening::at(const double p) const
  {
    if (inverse_ > 0.) {
      const double t = excess(p);
      // s^(m - 1) = (s + x) / s
      const double power = 1. + p / yield_strain_ / (1. + t);
      return {yield_ * t, yield_ / yield_strain_ / (inverse_ * power - 1.)};
    }
    return {linear_ * p - saturation_ * std::expm1(-decay_ * p),
            linear_ + saturation_ * decay_ * std::exp(-decay_ * p)};
  }

  double IsotropicHardening::mean(const double p, const double dp) const
  {
    if (inverse_ > 0.)
      return yield_ * mean_excess(excess(p), excess(p + dp));
    const double x = decay_ * dp;
    const double mean_decay =
        std::exp(-decay_ * p) * (x > 0. ? -std::expm1(-x) / x : 1.);
    return linear_ * (p + dp / 2.) + saturation_ * (1. - mean_decay);
  }

  double IsotropicHardening::energy(const double p) const
  {
    if (inverse_ > 0.)
      return p * yield_ * mean_excess(0., excess(p));
    const double x = decay_ * p;
    const double saturated =
        x > 0. ? saturation_ / decay_ * (x + std::expm1(-x)) : 0.;
    return linear_ / 2. * p * p + saturated;
  }
} // namespace nsfd
