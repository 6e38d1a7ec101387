#include "make_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

// Coulomb friction against the velocity that `sliding` names.
namespace nsfd::test_sliding
{
  namespace
  {
    using test::Scene;

    // One rigid cell on a floor, m = 1 kg, mu = 0.3, pressed on by its weight
    // of 10 N; in steps of 10 ms friction takes up to 0.03 N s.
    std::string mass_on_a_floor(const std::string &push,
                                const std::string &velocity)
    {
      return R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set lower corner = 0, 0
  set upper corner = 1, 1
  set cells        = 1, 1
end
subsection Material: block
  set model              = rigid
  set density            = 1
  set initial velocity x = )" +
             velocity + R"(
  set body force x       = )" +
             push + R"(
end
subsection Interface: none
  set law = rigid
end
subsection Obstacle: floor
  set where    = bottom
  set point    = 0, 0
  set normal   = 0, 1
  set friction = 0.3
end
subsection Loads
  set gravity = 0, -10
end
subsection Time
  set end  = 1e4 s
  set step = 10 ms
end
subsection Solver
  set tolerance = 1e-12
end
)";
    }

    // Pushes without a pattern, from a tenth to twice what friction holds: slip
    // that goes on, that turns and that stops.
    const char *const pushes = "6 * sin(1.7e4 * t^2) * sin(3.1 * t)";

    struct Given {
      double worst = 0.;        ///< of a step, over the largest energy
      unsigned int steps = 0;   ///< in which friction gave energy
      unsigned int at_rest = 0; ///< at the end
    };

    Given slide(const std::string &sliding, const std::string &theta,
                const std::string &motion, const unsigned int n_steps)
    {
      Scene<2> scene(mass_on_a_floor(pushes, "0.5"),
                     {"Time/sliding=" + sliding, "Time/theta=" + theta,
                      "motion=" + motion});
      Given given;
      for (unsigned int step = 0; step < n_steps; ++step) {
        const double before = scene.state.energy.friction;
        scene.advance();
        const State &now = scene.state;
        const double work = before - now.energy.friction;
        given.worst = std::max(given.worst, work / now.largest_energy);
        given.steps += work > 1e-12 * now.largest_energy;
        given.at_rest += now.energy.kinetic < 1e-20 * now.largest_energy;
      }
      return given;
    }
  } // namespace

  // Acary & Collins-Craft (2025): Coulomb's rule on the velocity at the end of
  // a step gives energy where slip turns, on the mean velocity it never rests.
  // The two together do neither.
  TEST(Sliding, EnergySafeFrictionNeverGivesEnergyAndRests)
  {
    for (const char *theta : {"0.5", "0.8"}) {
      SCOPED_TRACE(theta);
      const Given safe = slide("energy safe", theta, "small", 50000);
      EXPECT_LE(safe.worst, 1e-13); // round-off of sums
      EXPECT_EQ(safe.steps, 0u);
      EXPECT_GT(safe.at_rest, 1000u);
      // the pushes are such that the rule has something to do
      EXPECT_GT(slide("velocity", theta, "small", 2000).steps, 20u);
      const Given mean = slide("increment", theta, "small", 2000);
      EXPECT_EQ(mean.steps, 0u);
      // at theta > 1/2 what has stuck loses (1 - theta) / theta in every step
      if (theta == std::string("0.5")) {
        EXPECT_EQ(mean.at_rest, 0u);
      }
    }
    const Given large = slide("energy safe", "0.5", "large", 1000);
    EXPECT_EQ(large.steps, 0u);
    EXPECT_GT(large.at_rest, 10u);
  }

  TEST(Sliding, WhatFrictionCanHoldRestsAfterOneStep)
  {
    // 0.02 N s of momentum, less than 0.03 N s of friction
    const auto velocity_after_a_step = [](const std::string &sliding) {
      Scene<2> scene(mass_on_a_floor("0", "0.02"), {"Time/sliding=" + sliding});
      scene.advance();
      return std::sqrt(2. * scene.state.energy.kinetic);
    };
    EXPECT_NEAR(velocity_after_a_step("energy safe"), 0., 1e-12);
    EXPECT_NEAR(velocity_after_a_step("velocity"), 0., 1e-12);
    // friction takes all it can, 0.03 N s, and the mass goes back
    EXPECT_NEAR(velocity_after_a_step("increment"), 0.01, 1e-12);
  }
} // namespace nsfd::test_sliding
