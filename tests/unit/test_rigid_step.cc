// Rotations of rigid bodies against formulas and conservation.
#include "nsfd/bodies/rigid_step.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace test_rigid_step
{
  using namespace nsfd;
  using namespace nsfd::space;

  const double pi = std::acos(-1.);

  RigidInertia diagonal(const double a, const double b, const double c,
                        const double mass = 1.)
  {
    RigidInertia body;
    body.mass = mass;
    body.inertia = {{{a, 0., 0.}, {0., b, 0.}, {0., 0., c}}};
    return body;
  }

  RigidState spinning(const Vec3 &spin)
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

  RigidState turn_freely(const RigidInertia &body, const RigidState &state,
                         const double h, const unsigned int n)
  {
    return turn_freely(body, state, h, n, [](const RigidState &) {});
  }

  /** Largest entry of Lambda^T Lambda - 1. */
  double skewness(const RigidState &state)
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
  Drift drift(const RigidInertia &body, const RigidState &start, const double h,
              const unsigned int n)
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

  void expect_small(const Drift &d, const double tolerance)
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

  TEST(RigidStep, MomentaAreThoseOfTheLoad)
  {
    Random random;
    for (const double theta : {0.5, 0.75, 1.})
      for (unsigned int i = 0; i < 50; ++i) {
        const RigidInertia body = random.body();
        const RigidState start = random.state(3.);
        const RigidLoad load = random.load();
        const double h = 0.1;
        RigidStep step(body, start, h, theta);
        ASSERT_TRUE(step.solve(load));
        const Vec3 gained = angular_momentum(body, step.state()) -
                            angular_momentum(body, start);
        const Vec3 given = h * load.moment + load.angular_impulse;
        const double size = norm(angular_momentum(body, start)) + norm(given);
        EXPECT_LT(norm(gained - given), 1e-14 * size);
        EXPECT_LT(norm(body.mass * (step.state().velocity - start.velocity) -
                       h * load.force - load.impulse),
                  1e-14 * body.mass * norm(start.velocity));
      }
  }

  TEST(RigidStep, WorkIsTheChangeOfEnergyAndWhatThetaTakes)
  {
    Random random;
    for (const double theta : {0.5, 0.75, 1.})
      for (unsigned int i = 0; i < 50; ++i) {
        const RigidInertia body = random.body();
        const RigidState start = random.state(3.);
        const RigidLoad load = random.load();
        const double h = 0.1;
        RigidStep step(body, start, h, theta);
        ASSERT_TRUE(step.solve(load));
        const RigidVelocity v = step.theta_velocity();
        const double work = dot(v.centre, h * load.force + load.impulse) +
                            dot(v.spin, h * load.moment + load.angular_impulse);
        const double before = kinetic_energy(body, start),
                     after = kinetic_energy(body, step.state());
        EXPECT_NEAR(work, after - before + step.dissipated(),
                    1e-14 * (before + after));
        if (theta == 0.5)
          EXPECT_EQ(step.dissipated(), 0.);
        else
          EXPECT_GT(step.dissipated(), 0.);
      }
  }

  TEST(RigidStep, PointsMoveWithTheVelocityOfTheirRow)
  {
    Random random;
    for (const double theta : {0.5, 0.8, 1.})
      for (unsigned int i = 0; i < 50; ++i) {
        const RigidInertia body = random.body();
        const RigidState start = random.state(10.);
        const double h = 0.2;
        RigidStep step(body, start, h, theta);
        ASSERT_TRUE(step.solve(random.load()));
        const RigidVelocity v = step.theta_velocity();
        const Vec3 r0 = random.vector(1.);
        const auto place = [&r0](const RigidState &s) {
          return s.centre + rotation(s.orientation) * r0;
        };
        const Vec3 moved = place(step.state()) - place(start);
        const Vec3 row = v.centre + cross(v.spin, step.mid_arm(r0));
        EXPECT_LT(norm(moved - h * row),
                  1e-14 * (norm(place(start)) + norm(h * row)));
      }
  }

  /** m = Lambda_{k+1} J Lambda_k^T a - Lambda_k J W_k is what solve() makes
   *  equal to the load; its derivative by differences of solutions. */
  TEST(RigidStep, IterationMatrixIsTheSymmetricPartOfTheDerivative)
  {
    Random random;
    for (const double theta : {0.5, 1.}) {
      const RigidInertia body = random.body();
      const RigidState start = random.state(2.);
      const RigidLoad load = random.load();
      const double h = 0.1, d = 1e-5;
      const auto spin = [&](const unsigned int c, const double change) {
        RigidLoad changed = load;
        changed.angular_impulse[c] += change;
        RigidStep step(body, start, h, theta);
        EXPECT_TRUE(step.solve(changed));
        return step.velocity().spin;
      };
      Mat3 columns; // of da/dm
      for (unsigned int c = 0; c < 3; ++c)
        columns[c] = (1. / (2. * d)) * (spin(c, d) - spin(c, -d));
      const Mat3 inverse = transposed(columns);
      Mat3 derivative;
      for (unsigned int c = 0; c < 3; ++c) {
        Vec3 unit{};
        unit[c] = 1.;
        derivative[c] = solve(inverse, unit);
      }
      RigidStep step(body, start, h, theta);
      ASSERT_TRUE(step.solve(load));
      const auto matrix = step.iteration_matrix();
      double asymmetry = 0.;
      for (unsigned int r = 0; r < 3; ++r)
        for (unsigned int c = 0; c < 3; ++c) {
          EXPECT_NEAR(matrix[(r + 3) * 6 + c + 3],
                      (derivative[r][c] + derivative[c][r]) / 2., 1e-8);
          EXPECT_EQ(matrix[(r + 3) * 6 + c + 3], matrix[(c + 3) * 6 + r + 3]);
          EXPECT_EQ(matrix[r * 6 + c], r == c ? body.mass : 0.);
          EXPECT_EQ(matrix[r * 6 + c + 3], 0.);
          asymmetry = std::max(asymmetry,
                               std::abs(derivative[r][c] - derivative[c][r]));
        }
      EXPECT_GT(asymmetry, 1e-3);
    }
  }

  TEST(RigidStep, IterationMatrixStaysDefiniteInLargeSteps)
  {
    Random random;
    unsigned int limits = 0;
    for (unsigned int i = 0; i < 200; ++i) {
      const RigidInertia body = random.body();
      RigidStep step(body, random.turning(2., 0.3), 0.3, 0.5);
      ASSERT_TRUE(step.solve({}));
      const auto m = step.iteration_matrix();
      Mat3 A;
      for (unsigned int r = 0; r < 3; ++r)
        for (unsigned int c = 0; c < 3; ++c)
          A[r][c] = m[(r + 3) * 6 + c + 3];
      EXPECT_GT(A[0][0], 0.);
      EXPECT_GT(A[0][0] * A[1][1] - A[0][1] * A[1][0], 0.);
      EXPECT_GT(dot(A[0], cross(A[1], A[2])), 0.);
      const double trace =
          body.inertia[0][0] + body.inertia[1][1] + body.inertia[2][2];
      if (std::abs(A[0][0] + A[1][1] + A[2][2] - trace) < 1e-12 * trace)
        ++limits;
    }
    // both kinds are among them
    EXPECT_GT(limits, 0u);
    EXPECT_LT(limits, 200u);
  }

  TEST(RigidStep, TurnsOfTwoRadiansAreSolved)
  {
    Random random;
    for (unsigned int i = 0; i < 2000; ++i) {
      const RigidInertia body = random.body();
      RigidStep step(body, random.turning(2., 0.1), 0.1, 0.5);
      EXPECT_TRUE(step.solve({}, step.a_k())) << i;
    }
  }

  /** Far larger turns may be refused, but never done wrongly. */
  TEST(RigidStep, WhatIsSolvedIsSolved)
  {
    Random random;
    unsigned int refused = 0;
    for (unsigned int i = 0; i < 2000; ++i) {
      const RigidInertia body = random.body();
      const RigidState start = random.turning(10., 0.1);
      RigidStep step(body, start, 0.1, 0.5);
      const RigidState before = step.state();
      if (step.solve({})) {
        const double energy = kinetic_energy(body, start);
        EXPECT_NEAR(kinetic_energy(body, step.state()), energy, 1e-12 * energy);
      } else {
        ++refused;
        EXPECT_EQ(step.state().spin, before.spin);
        EXPECT_EQ(step.state().orientation, before.orientation);
      }
    }
    EXPECT_LT(refused, 400u);
  }

  TEST(RigidStep, WhatIsNotANumberIsRefused)
  {
    const RigidState start = spinning({1., 2., 3.});
    const double bad[] = {std::numeric_limits<double>::quiet_NaN(),
                          std::numeric_limits<double>::infinity()};
    for (const double x : bad) {
      RigidStep step(diagonal(1., 2., 3.), start, 0.1, 0.5);
      EXPECT_FALSE(step.solve({{}, {x, 0., 0.}, {}, {}}));
      EXPECT_FALSE(step.solve({{x, 0., 0.}, {}, {}, {}}));
      EXPECT_EQ(step.state().spin, start.spin);
      EXPECT_TRUE(step.solve({}));
    }
  }

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
} // namespace test_rigid_step
