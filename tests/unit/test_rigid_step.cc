#include "rigid_flights.h"

namespace rigid_flights::test_rigid_step
{
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
} // namespace rigid_flights::test_rigid_step
