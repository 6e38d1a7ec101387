#include "breaking_plate.h"
#include "make_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// Viscous traction against the opening of points that are not broken.

namespace nsfd::test_opening_viscosity
{
  namespace
  {
    const std::string blocks = R"(# blocks - two blocks of mass 1 fly apart.
set dimension = 2
subsection Mesh
  set lower corner = 0, 0
  set upper corner = 2, 1
  set cells        = 2, 1
end
subsection Discretization
  set interface points = 1
end
subsection Material: left
  set where              = x < 1
  set model              = rigid
  set density            = 1
  set initial velocity x = -1
end
subsection Material: right
  set model              = rigid
  set density            = 1
  set initial velocity x = 1
end
subsection Interface: face
  set law               = michel-suquet
  set strength          = 2
  set toughness         = 0.3
  set opening viscosity = 0.5
end
subsection Time
  set end  = 1
  set step = 0.01 s
end
)";

    TEST(OpeningViscosity, TakesWhatItSaysUntilThePointIsBroken)
    {
      for (const std::string theta : {"0.5", "0.8"}) {
        test::Scene<2> scene(blocks, {"Time/theta=" + theta});
        double viscous = 0., largest = 0.;
        unsigned int broken = 0;
        for (unsigned int k = 0; k < 150; ++k) {
          const State old = scene.state;
          EXPECT_LT(scene.advance().balance_residual, 1e-12);
          const double speed = (scene.state.jump[0] - old.jump[0]) / 0.01;
          EXPECT_GT(speed, 0.);
          if (old.beta[0] > 0.) {
            viscous += 0.01 * 0.5 * speed * speed;
            largest = std::max(largest, 0.5 * speed);
          } else {
            EXPECT_EQ(scene.state.velocity, old.velocity) << "free flight";
            ++broken;
          }
          EXPECT_NEAR(scene.state.energy.viscous, viscous, 1e-12);
        }
        EXPECT_GT(broken, 10u);
        EXPECT_NEAR(scene.state.energy.damage, 0.3, 1e-12);
        EXPECT_NEAR(*scene.state.viscous_traction, largest, 1e-12);
        // v^2 of both blocks is what is left
        const double v = scene.state.relative_velocity[0] / 2.;
        EXPECT_NEAR(v * v + 0.3 + viscous + scene.state.energy.numerical, 1.,
                    1e-12);
      }
      test::Scene<2> plain(blocks, {"Interface: face/opening viscosity=0"});
      plain.advance();
      EXPECT_FALSE(plain.state.viscous_traction);
      EXPECT_TRUE(plain.stepper->problem().viscosity.empty());
    }

    TEST(OpeningViscosity, EndsAtTheThresholdOfATail)
    {
      std::string tail = blocks;
      const std::string ductile = "michel-suquet\n  set strength          = 2\n"
                                  "  set toughness         = 0.3";
      tail.replace(tail.find(ductile), ductile.size(),
                   "rcc\n  set stiffness = 20\n  set adhesion energy = 0.3");
      test::Scene<2> scene(tail);
      unsigned int before = 0, after = 0;
      for (unsigned int k = 0; k < 250; ++k) {
        const State old = scene.state;
        scene.advance();
        EXPECT_GT(scene.state.beta[0], 0.);
        const bool drags = scene.state.energy.viscous > old.energy.viscous;
        EXPECT_EQ(drags, old.beta[0] > 1e-3);
        ++(drags ? before : after);
      }
      EXPECT_GT(before, 10u);
      EXPECT_GT(after, 10u);
    }

    TEST(OpeningViscosity, ClosesTheBalance)
    {
      for (const std::string path : {"local", "assembled"})
        for (const std::string solver : {"dual newton", "gauss seidel"})
          for (const std::string theta : {"0.5", "0.7"}) {
            SCOPED_TRACE(path + ", " + solver + ", theta " + theta);
            test::Scene<2> scene(
                test::breaking_plate,
                {"Interface: all/opening viscosity=2", "Solver/path=" + path,
                 "Solver/method=" + solver, "Solver/maximum iterations=1000",
                 "Time/theta=" + theta});
            double defect = 0., viscous = 0.;
            for (unsigned int k = 0; k < 40; ++k) {
              scene.advance_bisecting();
              const EnergyLines &e = scene.state.energy;
              EXPECT_GE(e.viscous, viscous) << "never gives back";
              viscous = e.viscous;
              const double sum = e.kinetic + e.elastic + e.cohesive + e.damage +
                                 e.friction + e.viscous + e.impact +
                                 e.numerical - e.work -
                                 scene.state.initial_energy;
              defect =
                  std::max(defect, std::abs(sum) / scene.state.largest_energy);
            }
            EXPECT_LT(defect, 1e-12);
            EXPECT_GT(viscous, 1e-3 * scene.state.initial_energy);
            EXPECT_GT(scene.state.energy.damage, 0.);
          }
    }
  } // namespace
} // namespace nsfd::test_opening_viscosity
