#pragma once

#include "core/bracketed_root.h"

#include "nsfd/scene/time_input.h"
#include "one_step_problem.h"

#include <algorithm>
#include <cmath>

/** The frozen parts of the law of a point, as functions of the velocity. */
namespace nsfd::springs
{
  constexpr double infinity = std::numeric_limits<double>::infinity();

  inline double square(const double x) { return x * x; }
  inline double positive(const double x) { return x > 0. ? x : 0.; }
  inline double negative(const double x) { return x < 0. ? x : 0.; }

  /**
   * Normal cohesive traction as a function of the normal velocity at fixed
   * secant b and compression stiffness c. End rules see x = x0 + s U; the
   * exact rule is the difference quotient of the potential
   * b <u>_+^2/2 + c <-u>_+^2/2 between u_k and u' = x0 + s U.
   */
  struct NormalSpring {
    double tension, compression; // b, c
    double offset, slope;        // x0, s
    double old;                  // u_k
    bool exact;

    double at(const double velocity) const
    {
      const double x = offset + slope * velocity;
      if (!exact)
        return tension * positive(x) + compression * negative(x);
      if (x >= 0. && old >= 0.)
        return tension * (x + old) / 2.;
      if (x <= 0. && old <= 0.)
        return compression * (x + old) / 2.;
      return (tension * (square(positive(x)) - square(positive(old))) +
              compression * (square(negative(x)) - square(negative(old)))) /
             (2. * (x - old));
    }

    /** dR/dU at @p velocity, from the side of the piece it lies in. */
    double derivative(const double velocity) const
    {
      const double x = offset + slope * velocity;
      const double mine = x > 0. ? tension : compression;
      if (!exact)
        return mine * slope;
      if (tension == compression)
        return mine * slope / 2.; // linear: the same bits at every velocity
      const double other = old > 0. ? tension : compression;
      if (x * old >= 0.)
        return (x == 0. ? other : mine) * slope / 2.;
      const double jump = x - old;
      return slope * (mine * (x * x - 2. * x * old) + other * old * old) /
             (2. * jump * jump);
    }

    /** U - U_loc + a R(U) = 0, a >= 0: one root, R is monotone. */
    double solve(const double local, const double a) const
    {
      if (tension == 0. && compression == 0.)
        return local;
      const double at_zero = -offset / slope; // the velocity with x = 0
      const bool opens = at_zero - local + a * at(at_zero) < 0.;
      const double mine = opens ? tension : compression;
      const double x_local = offset + slope * local;
      if (!exact)
        return (x_local / (1. + a * mine * slope) - offset) / slope;
      const double other = old > 0. ? tension : compression;
      const double k = a * slope;
      double x;
      if ((opens && old >= 0.) || (!opens && old <= 0.))
        x = (x_local - k * mine * old / 2.) / (1. + k * mine / 2.);
      else {
        // 2 (x - x_local)(x - old) + k (mine x^2 - other old^2) = 0
        const double p = 2. + k * mine, q = -2. * (x_local + old),
                     r = 2. * x_local * old - k * other * old * old;
        const double root = std::sqrt(std::max(0., q * q - 4. * p * r));
        // the root on the other side of zero than u_k
        const double t = -(q + std::copysign(root, q)) / 2.;
        const double first = t / p, second = t == 0. ? 0. : r / t;
        x = opens ? std::max(first, second) : std::min(first, second);
      }
      return (x - offset) / slope;
    }

    /** U with R(U) = traction; where no traction is possible: no root. */
    double inverse(const double traction) const
    {
      // R is continuous; x = 0 separates the pieces
      const double at_zero = at(-offset / slope);
      const bool opens = traction > at_zero;
      const double mine = opens ? tension : compression;
      double x;
      if (!exact)
        x = mine > 0. ? traction / mine : (opens ? infinity : -infinity);
      else {
        const double other = old > 0. ? tension : compression;
        if ((opens && old >= 0.) || (!opens && old <= 0.))
          x = mine > 0. ? 2. * traction / mine - old
                        : (opens ? infinity : -infinity);
        else {
          // mine x^2 - 2 R x + 2 R old - other old^2 = 0
          const double r = 2. * traction * old - other * old * old;
          if (mine > 0.) {
            const double root =
                std::sqrt(std::max(0., square(traction) - mine * r));
            x = (traction + (opens ? root : -root)) / mine;
          } else // a traction that only tends to zero
            x = (opens ? traction < 0. : traction > 0.)
                    ? r / (2. * traction)
                    : (opens ? infinity : -infinity);
        }
      }
      return (x - offset) / slope;
    }
  };

  /** x + dx, and 0 where only the round-off of the two is left. */
  inline double added_end(const double x, const double dx)
  {
    const double sum = x + dx;
    return std::abs(sum) <= 1e-15 * std::abs(x) ? 0. : sum;
  }

  /**
   * Normal traction of added openings over a step from @p start to @p end, with
   * the mean traction @p m: the quotient of m <u_N>_+. What is closed all the
   * time is held by the whole of it.
   */
  inline double added_normal_traction(const double m, const double start,
                                      const double end)
  {
    if (start >= 0. && end >= 0.)
      return m;
    return start <= 0. && end <= 0.
               ? 0.
               : m * (positive(end) - positive(start)) / (end - start);
  }

  /**
   * The spring, and next to it a viscous traction while the point opens: with
   * v = eta <U_theta>_+ = c <U - U_0>_+, c = eta theta and U_0 = -U_k
   * (1-theta)/theta, it is v, or v / (1 + v / limit) where the rate dependency
   * is limited.
   */
  struct NormalLaw {
    NormalSpring spring;
    double viscosity, start; // c, U_0
    double limit = infinity;

    /** No velocity is asked for by @p traction: all up to U_0 have it. */
    bool is_flat(const double traction) const
    {
      return spring.tension == 0. && spring.compression == 0. &&
             (viscosity == 0. || traction <= 0.);
    }

    bool drags(const double velocity) const
    {
      return viscosity > 0. && velocity > start;
    }

    /** The viscous traction, where it drags. */
    double drag(const double velocity) const
    {
      const double v = viscosity * (velocity - start);
      return v / (1. + v / limit);
    }

    double at(const double velocity) const
    {
      return drags(velocity) ? spring.at(velocity) + drag(velocity)
                             : spring.at(velocity);
    }

    double derivative(const double velocity) const
    {
      if (!drags(velocity))
        return spring.derivative(velocity);
      const double v = viscosity * (velocity - start);
      return spring.derivative(velocity) + viscosity / square(1. + v / limit);
    }

    /** U - U_loc + a R(U) = 0, a >= 0. */
    double solve(const double local, const double a) const
    {
      if (viscosity == 0. || start - local + a * spring.at(start) >= 0.)
        return spring.solve(local, a);
      // a limited drag is between the whole of it and nothing
      const double low = solve_dragged(local, a);
      if (limit == infinity || a == 0.)
        return low;
      return between(low, spring.solve(local, a),
                     [&](const double U) { return local - U - a * at(U); });
    }

    /** U with R(U) = traction. */
    double inverse(const double traction) const
    {
      if (viscosity == 0. || traction <= spring.at(start))
        return spring.inverse(traction);
      const double low =
          spring.solve(start + traction / viscosity, 1. / viscosity);
      if (limit == infinity)
        return low;
      if (spring.tension == 0.)
        return traction < limit
                   ? start + traction / (viscosity * (1. - traction / limit))
                   : infinity;
      return between(low, spring.inverse(traction),
                     [&](const double U) { return traction - at(U); });
    }

  private:
    double solve_dragged(const double local, const double a) const
    {
      const double share = a * viscosity, factor = 1. + share;
      return spring.solve((local + share * start) / factor, a / factor);
    }

    template <typename Function>
    double between(const double low, const double high, const Function &f) const
    {
      const double width = high - low;
      const auto shifted = [&](const double x) { return f(low + x); };
      const double f_low = f(low), f_high = f(high);
      if (!(f_low > 0.) || !(width > 0.))
        return low;
      return f_high >= 0.
                 ? high
                 : low + bracketed_root(shifted, 0., width, f_low, f_high);
    }
  };

  /** Tangential cohesive traction b tau (y0 + s U_T), per component. */
  struct TangentialSpring {
    double stiffness, slope;
  };

  template <int dim>
  double velocity_slope(const OneStepProblem<dim> &problem)
  {
    return problem.rule == CohesionRule::end_velocity
               ? problem.time_step
               : problem.time_step * problem.theta;
  }

  template <int dim>
  NormalSpring normal_spring(const OneStepProblem<dim> &problem,
                             const std::size_t i, const double secant)
  {
    const double old = problem.from_closed ? 0. : problem.jump_old[i * dim];
    return {secant,
            problem.compression_stiffness[i],
            problem.rule == CohesionRule::end_velocity
                ? old
                : problem.jump_free[i * dim],
            velocity_slope(problem),
            old,
            problem.rule == CohesionRule::exact};
  }

  template <int dim>
  NormalLaw normal_law(const OneStepProblem<dim> &problem, const std::size_t i,
                       const double secant)
  {
    const NormalSpring spring = normal_spring<dim>(problem, i, secant);
    if (problem.viscosity.empty() || problem.viscosity[i] == 0.)
      return {spring, 0., 0.};
    return {spring, problem.viscosity[i] * problem.theta,
            (problem.jump_old[i * dim] - problem.jump_free[i * dim]) /
                (problem.time_step * problem.theta),
            problem.interactions[problem.interaction[i]].viscous_limit};
  }

  /** y0 of the tangential spring R_T = b tau (y0 + s U_T). */
  template <int dim>
  double tangential_offset(const OneStepProblem<dim> &problem,
                           const std::size_t i, const unsigned int c)
  {
    const double old = problem.from_closed ? 0. : problem.jump_old[i * dim + c],
                 end = problem.jump_free[i * dim + c];
    switch (problem.rule) {
    case CohesionRule::exact:
      return (old + end) / 2.;
    case CohesionRule::end_velocity:
      return old;
    default:
      return end;
    }
  }

  template <int dim>
  TangentialSpring tangential_spring(const OneStepProblem<dim> &problem,
                                     const double secant)
  {
    return {secant, problem.rule == CohesionRule::exact
                        ? velocity_slope(problem) / 2.
                        : velocity_slope(problem)};
  }
} // namespace nsfd::springs
