#include "j2_flow.h"

#include "nsfd/scene/material_input.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    using Strain = J2Flow::Strain;

    constexpr unsigned int n_stresses = 6;

    Strain combine(const double a, const Strain &A, const double b,
                   const Strain &B)
    {
      Strain sum;
      for (unsigned int i = 0; i < n_stresses; ++i)
        sum[i] = a * A[i] + b * B[i];
      return sum;
    }
  } // namespace

  /** Isotropic moduli act on each of the two by a number. */
  struct J2Flow::Parts {
    std::array<Strain, 2> part; ///< the mean of the normal ones, the rest
  };

  /** Where the end of a step is on the surface. */
  struct J2Flow::Surface {
    double ratio = 0.; ///< of the increase of p to q
    double q = 0., flow = 0.;
    Parts eta;         ///< stress from the middle of the surface
    Strain normal;     ///< N, N:N = 3/2 in space
    double slope = 0.; ///< of yield + R + overstress by the flow
  };

  J2Flow::J2Flow(const double young, const double poisson,
                 const bool plane_stress, const PlasticInput &plastic)
      : lambda_(young * poisson / ((1. + poisson) * (1. - 2. * poisson))),
        mu_(young / (2. * (1. + poisson))), yield_(plastic.yield_stress),
        kinematic_(plastic.kinematic), viscosity_(plastic.viscosity),
        rate_exponent_(plastic.rate_exponent), rate_(plastic.reference_rate),
        hardening_(young, plastic), plane_stress_(plane_stress)
  {
    if (plane_stress)
      lambda_ = young * poisson / (1. - poisson * poisson);
    modulus_ = {(plane_stress ? 2. : 3.) * lambda_ + 2. * mu_, 2. * mu_};
    share_ = {plane_stress ? 1. / 3. : 0., 1.};
    for (unsigned int i = 0; i < 2; ++i)
      decay_[i] = kinematic_ + 1.5 * modulus_[i] * share_[i];
  }

  J2Flow::Parts J2Flow::split(const Strain &A) const
  {
    const unsigned int n = plane_stress_ ? 2 : 3;
    double mean = 0.;
    for (unsigned int c = 0; c < n; ++c)
      mean += A[c] / n;
    Parts parts{};
    parts.part[1] = A;
    for (unsigned int c = 0; c < n; ++c) {
      parts.part[0][c] = mean;
      parts.part[1][c] -= mean;
    }
    if (plane_stress_)
      parts.part[1][2] = parts.part[1][4] = parts.part[1][5] = 0.;
    return parts;
  }

  J2Flow::Strain J2Flow::join(const Parts &parts) const
  {
    return combine(1., parts.part[0], 1., parts.part[1]);
  }

  J2Flow::Strain J2Flow::times_modulus(const Strain &strain) const
  {
    const Parts parts = split(strain);
    return combine(modulus_[0], parts.part[0], modulus_[1], parts.part[1]);
  }

  J2Flow::Strain J2Flow::stress(const Strain &elastic) const
  {
    return times_modulus(elastic);
  }

  /** Of the surface; in plane stress the one without a stress along 33. */
  J2Flow::Strain J2Flow::middle(const Strain &alpha) const
  {
    Strain X = alpha;
    if (plane_stress_) {
      X[0] -= alpha[2];
      X[1] -= alpha[2];
      X[2] = X[4] = X[5] = 0.;
    }
    return combine(2. / 3. * kinematic_, X, 0., X);
  }

  double J2Flow::overstress(const double rate) const
  {
    if (viscosity_ == 0.)
      return 0.;
    return rate_exponent_ == 1.
               ? viscosity_ * rate
               : viscosity_ * rate_ *
                     std::pow(rate / rate_, 1. / rate_exponent_);
  }

  double J2Flow::overstress_slope(const double rate) const
  {
    if (viscosity_ == 0.)
      return 0.;
    return rate_exponent_ == 1. ? viscosity_
                                : overstress(rate) / (rate_exponent_ * rate);
  }

  double J2Flow::energy(const Strain &elastic,
                        const InternalVariables &variables) const
  {
    return contract<3>(elastic, times_modulus(elastic)) / 2. +
           kinematic_ / 3. * contract<3>(variables.alpha, variables.alpha) +
           hardening_.energy(variables.equivalent);
  }

  J2Flow::Tangent J2Flow::elastic_tangent(const double theta) const
  {
    Tangent result{};
    for (unsigned int j = 0; j < n_stresses; ++j) {
      Strain unit{};
      unit[j] = 1. / voigt_weight<3>(j);
      const Strain column = times_modulus(unit);
      for (unsigned int i = 0; i < n_stresses; ++i)
        result[i * n_stresses + j] = theta * column[i];
    }
    return result;
  }

  // The ratio of flow to q is the root of a function that falls: Newton's steps
  // within a bracket. With it each part of eta is that of the trial over
  // 1 + ratio decay.
  bool J2Flow::find_surface(const Parts &trial, const double p,
                            const double time_step, Surface &surface) const
  {
    constexpr unsigned int most_steps = 200;
    constexpr double round_off = std::numeric_limits<double>::epsilon();
    std::array<double, 2> square;
    for (unsigned int i = 0; i < 2; ++i)
      square[i] = 1.5 * share_[i] * contract<3>(trial.part[i], trial.part[i]);
    const double q_trial = std::sqrt(square[0] + square[1]);
    if (!std::isfinite(q_trial))
      return false;
    surface.q = q_trial;
    const double start = yield_ + hardening_.at(p).R;
    if (q_trial <= start || (viscosity_ > 0. && time_step == 0.))
      return true;
    double low = 0., high = std::numeric_limits<double>::infinity();
    // as if the surface stayed where it is
    double x = (q_trial - start) / (decay_[1] * start);
    if (viscosity_ > 0.) // no more than without anything else that resists
      x = std::min(x, time_step * rate_ *
                          std::pow((q_trial - start) / (viscosity_ * rate_),
                                   rate_exponent_) /
                          start);
    double slope = 0.;
    for (unsigned int k = 0; k < most_steps; ++k) {
      double q_square = 0., q_change = 0.;
      for (unsigned int i = 0; i < 2; ++i) {
        const double A = 1. / (1. + x * decay_[i]);
        q_square += A * A * square[i];
        q_change -= A * A * A * decay_[i] * square[i];
      }
      surface.q = std::sqrt(q_square);
      surface.flow = x * surface.q;
      q_change /= surface.q;
      const double rate = time_step > 0. ? surface.flow / time_step : 0.;
      const auto [R, dR] = hardening_.at(p + surface.flow);
      slope = dR;
      if (viscosity_ > 0.)
        slope += overstress_slope(rate) / time_step;
      const double left = surface.q - yield_ - R - overstress(rate);
      (left > 0. ? low : high) = x;
      if (std::abs(left) <= round_off * surface.q)
        break;
      const double change =
          left / (slope * (surface.q + x * q_change) - q_change);
      double next = x + change;
      if (!(next > low && next < high))
        next = std::isinf(high) ? 2. * x : (low + high) / 2.;
      if (next == x || next == low || next == high)
        break;
      x = next;
    }
    surface.ratio = x;
    surface.slope = slope;
    for (unsigned int i = 0; i < 2; ++i)
      surface.eta.part[i] =
          combine(1. / (1. + x * decay_[i]), trial.part[i], 0., trial.part[i]);
    surface.normal = combine(1.5 / surface.q * share_[0], surface.eta.part[0],
                             1.5 / surface.q * share_[1], surface.eta.part[1]);
    return std::isfinite(x);
  }

  bool J2Flow::step(const Strain &start, const Strain &trial,
                    const InternalVariables &variables, const double time_step,
                    const double theta, const bool with_tangent,
                    Step &result) const
  {
    const Strain beta = middle(variables.alpha), s_start = times_modulus(start),
                 change = combine(1., trial, -1., start),
                 eta_start = combine(1., s_start, -1., beta);
    Surface surface;
    if (!find_surface(split(combine(1., times_modulus(trial), -1., beta)),
                      variables.equivalent, time_step, surface))
      return false;
    result.flow = surface.flow;
    result.plastic = result.viscous = result.numerical = result.added = 0.;
    result.plastic_strain = {};
    Strain elastic = trial;
    if (surface.flow > 0.) {
      const Strain in_plane =
          combine(surface.flow, surface.normal, 0., surface.normal);
      elastic = combine(1., trial, -1., in_plane);
      result.plastic_strain = in_plane;
      if (plane_stress_)
        result.plastic_strain[2] = -in_plane[0] - in_plane[1];
    }
    const Strain s_end = times_modulus(elastic),
                 jump = combine(1., s_end, -1., s_start);
    result.stress = combine(1., s_start, theta, jump);
    result.numerical = (theta - 0.5) * contract<3>(jump, change);
    if (surface.flow > 0.) {
      const double p = variables.equivalent, dp = surface.flow;
      const double R_0 = hardening_.at(p).R, R_1 = hardening_.at(p + dp).R,
                   chord = hardening_.mean(p, dp) - (R_0 + R_1) / 2.;
      const double over = contract<3>(surface.normal, eta_start) - yield_ - R_0;
      double missing = std::max(0., -over) / 2.;
      result.plastic = dp * yield_;
      if (viscosity_ == 0.)
        missing += chord;
      else {
        result.viscous =
            dp / 2. *
            (std::max(0., over) + std::max(0., surface.q - yield_ - R_1));
        result.numerical -= dp * chord;
      }
      const Strain direction = times_modulus(surface.normal);
      const double along = contract<3>(direction, change);
      if (missing != 0. && along != 0.) { // else round-off of a step of no way
        result.added = dp * missing;
        result.stress =
            combine(1., result.stress, result.added / along, direction);
      }
    }
    if (with_tangent) {
      if (surface.flow > 0.)
        set_tangent(surface, variables, change, eta_start, theta, result);
      else
        result.tangent = elastic_tangent(theta);
    }
    return std::isfinite(contract<3>(result.stress, result.stress));
  }

  /** Differentials of all of step() along each entry of the trial. */
  void J2Flow::set_tangent(const Surface &surface,
                           const InternalVariables &variables,
                           const Strain &change, const Strain &eta_start,
                           const double theta, Step &result) const
  {
    const double p = variables.equivalent, dp = surface.flow, q = surface.q,
                 x = surface.ratio, Y = surface.slope;
    const Strain &N = surface.normal, direction = times_modulus(N);
    std::array<double, 2> A;
    double decay = 0.;
    for (unsigned int i = 0; i < 2; ++i) {
      A[i] = 1. / (1. + x * decay_[i]);
      decay += 1.5 * share_[i] * A[i] * decay_[i] / q *
               contract<3>(surface.eta.part[i], surface.eta.part[i]);
    }
    const double R_0 = hardening_.at(p).R, mean = hardening_.mean(p, dp);
    const auto [R_1, slope_1] = hardening_.at(p + dp);
    const double chord = mean - (R_0 + R_1) / 2.;
    const double below = std::max(0., yield_ + R_0 - contract<3>(N, eta_start));
    const bool with_chord = viscosity_ == 0.;
    const double missing = below / 2. + (with_chord ? chord : 0.);
    const double chord_slope =
        with_chord ? (R_1 - mean) / dp - slope_1 / 2. : 0.;
    const double way = contract<3>(direction, change);
    const double share = missing != 0. ? dp * missing / way : 0.;
    for (unsigned int j = 0; j < n_stresses; ++j) {
      Strain unit{};
      unit[j] = 1. / voigt_weight<3>(j);
      const Parts d_trial = split(times_modulus(unit));
      double pull = 0.;
      for (unsigned int i = 0; i < 2; ++i)
        pull += A[i] * contract<3>(N, d_trial.part[i]);
      const double d_flow = pull * q / (Y * q + (1. - Y * x) * decay);
      const double d_ratio = (1. - x * Y) * d_flow / q, d_q = Y * d_flow;
      Strain dN{};
      for (unsigned int i = 0; i < 2; ++i) {
        const Strain d_eta =
            combine(A[i], d_trial.part[i], -A[i] * decay_[i] * d_ratio,
                    surface.eta.part[i]);
        dN = combine(1., dN, 1.5 * share_[i] / q, d_eta);
      }
      dN = combine(1., dN, -d_q / q, N);
      const Strain d_direction = times_modulus(dN);
      Strain d_stress =
          combine(theta, times_modulus(unit), -theta * d_flow, direction);
      d_stress = combine(1., d_stress, -theta * dp, d_direction);
      if (missing != 0.) {
        const double d_below = below > 0. ? -contract<3>(dN, eta_start) : 0.;
        const double d_work =
            d_flow * missing + dp * (d_below / 2. + chord_slope * d_flow);
        const double d_way = contract<3>(d_direction, change) + direction[j];
        d_stress =
            combine(1., d_stress, (d_work - share * d_way) / way, direction);
        d_stress = combine(1., d_stress, share, d_direction);
      }
      for (unsigned int i = 0; i < n_stresses; ++i)
        result.tangent[i * n_stresses + j] = d_stress[i];
    }
  }
} // namespace nsfd
