#pragma once

// Rotations of rigid bodies against formulas and conservation.
#include "nsfd/bodies/rigid_step.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace rigid_flights
{
  using namespace nsfd;
  using namespace nsfd::space;

  const double pi = std::acos(-1.);

  inline RigidInertia diagonal(const double a, const double b, const double c,
                               const double mass = 1.)
  {
    RigidInertia body;
    body.mass = mass;
    body.inertia = {{{a, 0., 0.}, {0., b, 0.}, {0., 0., c}}};
    return body;
  }

  inline RigidState spinning(const Vec3 &spin)
  {
    RigidState state;
    state.spin = spin;
    return state;
  }

  /** @p n free steps; @p look sees every state. */
  template <typename Look>
  RigidState turn_freely(const RigidInertia &body, RigidState state,
                         const double h, const unsigned int n, Look look,
                         const double theta = 0.5)
  {
    for (unsigned int i = 0; i < n; ++i) {
      RigidStep step(body, state, h, theta);
      EXPECT_TRUE(step.solve({}, step.a_k())) << "step " << i;
      state = step.state();
      look(state);
    }
    return state;
  }

  inline RigidState turn_freely(const RigidInertia &body,
                                const RigidState &state, const double h,
                                const unsigned int n)
  {
    return turn_freely(body, state, h, n, [](const RigidState &) {});
  }

  /** Largest entry of Lambda^T Lambda - 1. */
  inline double skewness(const RigidState &state)
  {
    const Mat3 R = rotation(state.orientation), G = transposed(R) * R;
    double largest = 0.;
    for (unsigned int r = 0; r < 3; ++r)
      for (unsigned int c = 0; c < 3; ++c)
        largest = std::max(largest, std::abs(G[r][c] - (r == c)));
    return largest;
  }

  struct Drift {
    double energy = 0., momentum = 0., skewness = 0.; ///< relative, largest
  };

  /** Of a body that turns freely, over @p n steps. */
  inline Drift drift(const RigidInertia &body, const RigidState &start,
                     const double h, const unsigned int n)
  {
    const double energy = kinetic_energy(body, start);
    const Vec3 L = angular_momentum(body, start);
    Drift d;
    turn_freely(body, start, h, n, [&](const RigidState &state) {
      d.energy = std::max(d.energy,
                          std::abs(kinetic_energy(body, state) / energy - 1.));
      d.momentum = std::max(d.momentum,
                            norm(angular_momentum(body, state) - L) / norm(L));
      d.skewness = std::max(d.skewness, skewness(state));
    });
    return d;
  }

  inline void expect_small(const Drift &d, const double tolerance)
  {
    EXPECT_LT(d.energy, tolerance);
    EXPECT_LT(d.momentum, tolerance);
    EXPECT_LT(d.skewness, 1e-12);
  }

  /** A body and a step with nothing special about them. */
  struct Random {
    std::mt19937 generator{7};

    Vec3 vector(const double size)
    {
      std::uniform_real_distribution<double> uniform(-size, size);
      Vec3 v;
      for (double &c : v)
        c = uniform(generator);
      return v;
    }
    /** Full, with moments of inertia that a body may have. */
    RigidInertia body()
    {
      RigidInertia b;
      b.mass = 1.7;
      for (unsigned int i = 0; i < 4; ++i) {
        const Vec3 r = vector(1.);
        const Mat3 R = hat(r);
        b.inertia = b.inertia + (-1.) * (R * R);
      }
      return b;
    }
    RigidState state(const double spin)
    {
      RigidState s;
      const Vec3 q = vector(1.);
      s.orientation = normalized({0.3, q[0], q[1], q[2]});
      s.centre = vector(1.);
      s.velocity = vector(1.);
      s.spin = vector(spin);
      return s;
    }
    /** That turns by @p angle in the time @p h. */
    RigidState turning(const double angle, const double h)
    {
      RigidState s = state(1.);
      s.spin = (angle / (h * norm(s.spin))) * s.spin;
      return s;
    }
    RigidLoad load()
    {
      return {vector(1.), vector(1.), vector(0.3), vector(0.3)};
    }
  };
} // namespace rigid_flights
