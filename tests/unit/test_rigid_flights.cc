#include "rigid_flights.h"

namespace rigid_flights::test_rigid_flights
{
  TEST(RigidStep, SymmetricTopPrecesses)
  {
    const RigidInertia body = diagonal(2., 2., 1.);
    const RigidState start = spinning({0.3, 0., 5.});
    const double h = 1e-3;
    const unsigned int n = 20000;

    // angles of the transverse spin in the body and of the axis about L
    const Vec3 L = angular_momentum(body, start);
    const Vec3 e = (1. / norm(L)) * L;
    const Vec3 x = cross({0., 1., 0.}, e), y = cross(e, x);
    double in_body = 0., in_space = 0., last_body = 0., last_space = 0.;
    const auto axis_angle = [&](const RigidState &s) {
      const Vec3 axis = rotation(s.orientation) * Vec3{0., 0., 1.};
      return std::atan2(dot(axis, y), dot(axis, x));
    };
    last_space = axis_angle(start);
    turn_freely(body, start, h, n, [&](const RigidState &s) {
      const double b = std::atan2(s.spin[1], s.spin[0]), a = axis_angle(s);
      in_body += std::remainder(b - last_body, 2. * pi);
      in_space += std::remainder(a - last_space, 2. * pi);
      last_body = b;
      last_space = a;
    });
    // the rule is the implicit midpoint rule of Euler's equations
    EXPECT_NEAR(in_body / (n * h), -2. / h * std::atan(2.5 * h / 2.), 1e-11);
    EXPECT_NEAR(in_body / (n * h), -2.5, 2e-6);
    EXPECT_NEAR(in_space / (n * h), 2.5179357, 1e-5);
  }

  TEST(RigidStep, NothingDriftsInAMillionSteps)
  {
    expect_small(
        drift(diagonal(2., 2., 1.), spinning({0.3, 0., 5.}), 1e-2, 1000000),
        5e-12);
  }

  TEST(RigidStep, NothingDriftsInAMillionStepsOfAGeneralBody)
  {
    Random random;
    const RigidInertia body = random.body();
    const RigidState start = random.state(3.);
    expect_small(drift(body, start, 0.05, 1000000), 5e-12);
  }

  /** Times at which the middle spin of a tumbling body changes its sign. */
  TEST(RigidStep, TumblingBodyFlipsInTime)
  {
    const RigidInertia body = diagonal(1., 2., 3.);
    const double h = 2e-3;
    std::vector<double> flips;
    double t = 0., last = 1.;
    turn_freely(body, spinning({0.01, 1., 0.01}), h, 35000,
                [&](const RigidState &s) {
                  if (s.spin[1] * last < 0.)
                    flips.push_back(t + h * last / (last - s.spin[1]));
                  last = s.spin[1];
                  t += h;
                });
    ASSERT_EQ(flips.size(), 4u);
    EXPECT_NEAR(flips[0], 10.9169, 1e-4);
    for (unsigned int i = 1; i < 4; ++i)
      EXPECT_NEAR(flips[i] - flips[i - 1], 19.5529, 1e-4);
  }

  /** Euler's equations by Runge and Kutta's rule of fourth order. */
  RigidState reference(const RigidInertia &body, RigidState state,
                       const double end, const unsigned int n)
  {
    const double h = end / n;
    struct Rate {
      Quaternion q;
      Vec3 W;
    };
    const auto rate = [&body](const RigidState &s) {
      const Vec3 W = s.spin;
      Rate r;
      r.q = product(s.orientation, {0., W[0] / 2., W[1] / 2., W[2] / 2.});
      r.W = solve(body.inertia, cross(body.inertia * W, W));
      return r;
    };
    const auto moved = [](RigidState s, const Rate &r, const double by) {
      for (unsigned int c = 0; c < 4; ++c)
        s.orientation[c] += by * r.q[c];
      s.spin = s.spin + by * r.W;
      return s;
    };
    for (unsigned int i = 0; i < n; ++i) {
      const Rate a = rate(state), b = rate(moved(state, a, h / 2.)),
                 c = rate(moved(state, b, h / 2.)),
                 d = rate(moved(state, c, h));
      state = moved(state, a, h / 6.);
      state = moved(state, b, h / 3.);
      state = moved(state, c, h / 3.);
      state = moved(state, d, h / 6.);
    }
    return state;
  }

  TEST(RigidStep, IsOfSecondOrder)
  {
    const RigidInertia body = diagonal(1., 2., 3.);
    const RigidState start = spinning({0.01, 1., 0.01});
    const double end = 30.;
    const RigidState exact = reference(body, start, end, 60000);
    const Mat3 R = rotation(exact.orientation);
    std::vector<double> x, y;
    for (unsigned int n = 3000; n <= 48000; n *= 2) {
      const RigidState s = turn_freely(body, start, end / n, n);
      const Mat3 S = rotation(s.orientation);
      double error = dot(s.spin - exact.spin, s.spin - exact.spin);
      for (unsigned int r = 0; r < 3; ++r)
        error += dot(S[r] - R[r], S[r] - R[r]);
      x.push_back(std::log(end / n));
      y.push_back(std::log(error) / 2.);
    }
    double mean_x = 0., mean_y = 0., xx = 0., xy = 0.;
    for (unsigned int i = 0; i < x.size(); ++i) {
      mean_x += x[i] / double(x.size());
      mean_y += y[i] / double(x.size());
    }
    for (unsigned int i = 0; i < x.size(); ++i) {
      xx += (x[i] - mean_x) * (x[i] - mean_x);
      xy += (x[i] - mean_x) * (y[i] - mean_y);
    }
    EXPECT_NEAR(xy / xx, 2., 0.02);
    EXPECT_LT(y.back(), std::log(1e-5));
  }

  /** A top on its tip, about which its inertia is. */
  struct HeavyTop {
    const RigidInertia body = diagonal(0.02, 0.02, 0.01);
    const Vec3 weight{0., 0., -9.81}, arm{0., 0., 0.1};
    RigidState state;

    /** Steady at @p rate, leaning by 30 degrees. */
    explicit HeavyTop(const double rate)
    {
      const double lean = pi / 6.;
      state.orientation = {std::cos(lean / 2.), 0., std::sin(lean / 2.), 0.};
      state.spin = {-rate * std::sin(lean), 0., 100.};
    }

    /** The moment is that of the middle of the step, which follows from it. */
    void advance(const double h)
    {
      RigidStep step(body, state, h, 0.5);
      Vec3 moment{}, next = cross(step.mid_arm(arm), weight);
      for (unsigned int i = 0;
           i < 20 && norm(next - moment) > 1e-15 * norm(next); ++i) {
        moment = next;
        ASSERT_TRUE(step.solve({{}, moment, {}, {}}, step.a_k()));
        next = cross(step.mid_arm(arm), weight);
      }
      state = step.state();
    }

    Vec3 axis() const { return rotation(state.orientation) * arm; }
    double energy() const
    {
      return kinetic_energy(body, state) - dot(weight, axis());
    }
  };

  void expect_steady(const double rate, const double h, const double time)
  {
    HeavyTop top(rate);
    const double energy = top.energy(),
                 about_z = angular_momentum(top.body, top.state)[2],
                 height = top.axis()[2];
    double angle = 0., last = 0., nutation = 0.;
    const unsigned int n = static_cast<unsigned int>(time / h);
    for (unsigned int i = 0; i < n; ++i) {
      top.advance(h);
      const Vec3 axis = top.axis();
      const double now = std::atan2(axis[1], axis[0]);
      angle += std::remainder(now - last, 2. * pi);
      last = now;
      nutation = std::max(nutation, std::abs(axis[2] - height));
    }
    EXPECT_NEAR(angle / (n * h), rate, 1e-5 * rate);
    EXPECT_LT(nutation, 1e-5 * norm(top.arm));
    EXPECT_NEAR(top.energy(), energy, 1e-12 * energy);
    EXPECT_NEAR(angular_momentum(top.body, top.state)[2], about_z,
                1e-12 * about_z);
  }

  TEST(RigidStep, HeavyTopPrecessesSlowly)
  {
    expect_steady(0.9982603, 5e-5, 2.);
  }

  TEST(RigidStep, HeavyTopPrecessesFast) { expect_steady(56.736767, 5e-5, 1.); }

  TEST(RigidStep, BackwardStepsDissipate)
  {
    const RigidInertia body = diagonal(1., 2., 3.);
    const RigidState start = spinning({0.3, 1., 0.2});
    double last = kinetic_energy(body, start);
    const double first = last;
    const Vec3 L = angular_momentum(body, start);
    const RigidState end = turn_freely(
        body, start, 0.1, 2000,
        [&](const RigidState &s) {
          EXPECT_LE(kinetic_energy(body, s), last * (1. + 1e-14));
          last = kinetic_energy(body, s);
        },
        1.);
    EXPECT_LT(last, 0.9 * first);
    // what is left is the least that the momentum allows, about the third axis
    EXPECT_NEAR(last, dot(L, L) / (2. * 3.), 1e-3 * last);
    EXPECT_LT(norm(angular_momentum(body, end) - L), 1e-12 * norm(L));
  }

  TEST(RigidStep, TenThousandTurnsOfAPlaneBody)
  {
    const RigidInertia body = plane_inertia(2., 0.4);
    const double h = 0.1, spin = 3.;
    // each step turns by 2 atan(h W / 2)
    const double angle = 2. * std::atan(h * spin / 2.);
    const unsigned int n =
        static_cast<unsigned int>(std::ceil(1e4 * 2. * pi / angle));
    RigidState state = spinning({0., 0., spin});
    state.velocity = {1., -2., 0.};
    const RigidState end = turn_freely(body, state, h, n);
    const double rest = std::remainder(n * angle, 2. * pi);
    const Mat3 R = rotation(end.orientation);
    EXPECT_NEAR(std::atan2(R[1][0], R[0][0]), rest, 1e-10);
    EXPECT_EQ(end.spin, (Vec3{0., 0., spin}));
    EXPECT_EQ(R[2], (Vec3{0., 0., 1.}));
    EXPECT_LT(skewness(end), 1e-14);
    EXPECT_NEAR(end.centre[1], -2. * n * h, 1e-10 * n * h);
    EXPECT_EQ(end.centre[2], 0.);
  }
} // namespace rigid_flights::test_rigid_flights
