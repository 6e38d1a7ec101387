#include "breaking_plate.h"
#include "make_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// Pressure in open cracks, (22) of [AM06]. Two rigid unit blocks of mass 1
// next to each other: accelerations are numbers by hand, and 1e-12 is the
// round-off of some hundred steps.

namespace nsfd::test_crack_pressure
{
  namespace
  {
    const std::string blocks = R"(# blocks - two blocks with one face.
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
  set where   = x < 1
  set model   = rigid
  set density = 1
end
subsection Material: right
  set model   = rigid
  set density = 1
end
)";

    const std::string time = R"(
subsection Time
  set end  = 1
  set step = 0.01 s
end
)";

    const std::string crack = blocks + R"(
subsection Interface: crack
  set law            = contact
  set friction       = 0.4
  set crack pressure = 0.3
end
)" + time;

    const std::string pressed = R"(
subsection Boundary: left
  set traction x = 1
end
subsection Boundary: right
  set traction x = -1
end
)";

    TEST(CrackPressure, PushesTheCrackFacesApart)
    {
      // v = p t / m each, u_N = p t^2
      test::Scene<2> scene(crack);
      for (unsigned int k = 1; k <= 100; ++k) {
        const StepReport report = scene.advance();
        const double t = 0.01 * k;
        EXPECT_NEAR(scene.state.relative_velocity[0], 0.6 * t, 1e-12);
        EXPECT_NEAR(scene.state.jump[0], 0.3 * t * t, 1e-12);
        EXPECT_NEAR(scene.state.pressure_work, 0.09 * t * t, 1e-12);
        EXPECT_EQ(scene.state.energy.work, scene.state.pressure_work);
        EXPECT_EQ(scene.state.impulse[0], 0.) << "no contact";
        EXPECT_LT(report.balance_residual, 1e-12);
      }
    }

    TEST(CrackPressure, IsTakenAtTheTimeOfTheScheme)
    {
      // p = t: v = t^2 / 2, which the middle of a step integrates exactly; at
      // its end every step of h has h^2 / 2 too much
      for (const double theta : {0.5, 1.}) {
        test::Scene<2> scene(crack, {"Interface: crack/crack pressure=t",
                                     "Time/theta=" + std::to_string(theta)});
        for (unsigned int k = 1; k <= 50; ++k)
          scene.advance();
        EXPECT_NEAR(scene.state.relative_velocity[0],
                    0.25 + (2. * theta - 1.) * 50. * 1e-4, 1e-12);
      }
    }

    TEST(CrackPressure, AddsToTheContact)
    {
      // pressed with 1 from outside: contact carries F = 1 - p, the crack faces
      // F + p
      test::Scene<2> scene(crack + pressed);
      for (unsigned int k = 0; k < 20; ++k) {
        EXPECT_LT(scene.advance().balance_residual, 1e-12);
        EXPECT_NEAR(scene.state.impulse[0] / 0.01, 0.7, 1e-12);
        EXPECT_NEAR(scene.state.impulse[0] / 0.01 + scene.state.pressure[0], 1.,
                    1e-12);
        EXPECT_NEAR(scene.state.jump[0], 0., 1e-14);
        EXPECT_TRUE(scene.state.contact[0]);
      }
      // and more pressure than that opens
      test::Scene<2> open(crack + pressed,
                          {"Interface: crack/crack pressure=1.5"});
      for (unsigned int k = 0; k < 20; ++k)
        open.advance();
      EXPECT_EQ(open.state.impulse[0], 0.);
      EXPECT_NEAR(open.state.relative_velocity[0], 2. * 0.5 * 0.2, 1e-12);
    }

    TEST(CrackPressure, FrictionSeesTheContactOnly)
    {
      test::Scene<2> scene(crack + pressed,
                           {"Material: left/initial velocity y=-0.5",
                            "Material: right/initial velocity y=0.5"});
      for (unsigned int k = 0; k < 10; ++k) {
        scene.advance();
        EXPECT_NEAR(std::abs(scene.state.impulse[1]) / 0.01, 0.4 * 0.7, 1e-12);
      }
    }

    /** Blocks that fly apart with 1 each, and what holds them. */
    std::string separation(const std::string &law)
    {
      return blocks + "subsection Interface: crack\n  set law = " + law +
             "\nend\n" + time;
    }
    const std::vector<std::string> apart = {
        "Material: left/initial velocity x=-1",
        "Material: right/initial velocity x=1"};

    std::vector<std::string> with_pressure(const std::string &value = "0.3")
    {
      auto result = apart;
      result.push_back("Interface: crack/crack pressure=" + value);
      return result;
    }

    TEST(CrackPressure, ActsOnceThePointIsBroken)
    {
      for (const std::string law :
           {"michel-suquet\n  set strength = 2\n  set toughness = 0.5",
            "tvergaard\n  set strength = 2\n  set toughness = 0.5",
            "camacho-ortiz\n  set strength = 2\n  set toughness = 0.5\n"
            "  set where = x > 0"}) {
        SCOPED_TRACE(law);
        test::Scene<2> plain(separation(law), apart),
            scene(separation(law), with_pressure());
        unsigned int intact = 0, damaged = 0, broken = 0;
        for (unsigned int k = 0; k < 100; ++k) {
          const State old = scene.state;
          EXPECT_LT(scene.advance().balance_residual, 1e-12);
          plain.advance();
          const double force =
              (scene.state.relative_velocity[0] - old.relative_velocity[0]) /
              2. / 0.01;
          if (old.beta[0] > 0.) {
            // not there at all
            EXPECT_EQ(scene.state.velocity, plain.state.velocity);
            EXPECT_EQ(scene.state.pressure[0], 0.);
            EXPECT_NEAR(force, scene.state.impulse[0] / 0.01, 1e-10);
            ++(old.beta[0] < 1. ? damaged : intact);
          } else {
            EXPECT_EQ(scene.state.pressure[0], 0.3);
            EXPECT_NEAR(force, 0.3, 1e-10) << "a jump of p";
            EXPECT_EQ(scene.state.impulse[0], 0.);
            ++broken;
          }
        }
        EXPECT_GT(intact, 0u);
        EXPECT_GT(damaged, 10u);
        EXPECT_GT(broken, 10u);
        EXPECT_TRUE(plain.state.pressure.empty());
        EXPECT_EQ(plain.state.pressure_work, 0.);
      }
    }

    TEST(CrackPressure, LawsWithATailHaveAThreshold)
    {
      const std::string rcc =
          "rcc\n  set stiffness = 20\n  set adhesion energy = 0.5";
      auto wider = with_pressure();
      wider.push_back("Interface: crack/pressure threshold=0.1");
      for (const auto &[overrides, threshold] :
           {std::pair(with_pressure(), 1e-3), std::pair(wider, 0.1)}) {
        test::Scene<2> scene(separation(rcc), overrides);
        unsigned int before = 0, after = 0;
        for (unsigned int k = 0; k < 100; ++k) {
          const double beta = scene.state.beta[0];
          scene.advance();
          EXPECT_GT(scene.state.beta[0], 0.);
          EXPECT_EQ(scene.state.pressure[0], beta <= threshold ? 0.3 : 0.);
          ++(beta <= threshold ? after : before);
        }
        EXPECT_GT(before, 10u);
        EXPECT_GT(after, 10u);
      }
    }

    TEST(CrackPressure, ClosesTheBalance)
    {
      // elastic cells that break, rub and are blown apart, in space and time
      for (const std::string path : {"local", "assembled"})
        for (const std::string theta : {"0.5", "0.7"}) {
          SCOPED_TRACE(path + ", theta " + theta);
          test::Scene<2> scene(
              test::breaking_plate,
              {"Interface: all/broken=abs(y - 1/3) < 0.05 && x < 1.5",
               "Interface: all/crack pressure=(1 + x) * sin(9 * t)",
               "Solver/path=" + path, "Time/theta=" + theta});
          double defect = 0.;
          for (unsigned int k = 0; k < 60; ++k) {
            scene.advance_bisecting();
            const EnergyLines &e = scene.state.energy;
            const double sum = e.kinetic + e.elastic + e.cohesive + e.damage +
                               e.friction + e.impact + e.numerical - e.work -
                               scene.state.initial_energy;
            defect =
                std::max(defect, std::abs(sum) / scene.state.largest_energy);
          }
          EXPECT_LT(defect, 1e-12);
          EXPECT_GT(scene.state.pressure_work, 1e-3);
          EXPECT_EQ(scene.state.pressure_work, scene.state.energy.work);
          EXPECT_GT(scene.state.broken_area, 0.);
        }
    }
  } // namespace
} // namespace nsfd::test_crack_pressure
