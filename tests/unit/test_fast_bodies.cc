// Implicit steps in which bodies pass each other by many times their
// thickness: what touches on the way is not missed.
#include "fast_scenes.h"
#include "make_scene.h"

#include "time_integration/time_integrator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

using namespace nsfd;
using namespace nsfd::test;
using namespace nsfd::test::fast;

namespace test_fast_bodies
{
  /** Where a rigid body is, and how fast. */
  template <int dim>
  double centre(const Scene<dim> &scene, const std::size_t body,
                const unsigned int component = 0)
  {
    return scene.state.rigid[13 * body + component];
  }
  template <int dim>
  double velocity(const Scene<dim> &scene, const std::size_t body,
                  const unsigned int component = 0)
  {
    return scene.state.rigid[13 * body + 3 + component];
  }

  template <int dim>
  void run_to(Scene<dim> &scene, const double end)
  {
    while (scene.state.time < end)
      scene.advance_bisecting();
  }

  // up to 40 times the thickness in a step; 8 to 9.5 ms flew through, others
  // were caught by luck of where their steps ended
  TEST(FastBodies, FoilIsNotPassed)
  {
    for (const double e : {0., 1.})
      for (const double step :
           {0.5, 1., 2., 3., 5.2, 7.5, 8., 8.5, 9., 9.5, 15., 30., 40.}) {
        SCOPED_TRACE(std::to_string(step) + " ms, e " + std::to_string(e));
        Scene<2> scene(shot_and_foil,
                       {"Time/step=" + std::to_string(step) + " ms",
                        "Contact: all/restitution=" + std::to_string(e)});
        while (scene.state.time < 0.08) {
          scene.advance_bisecting();
          // no deeper than half of the foil
          EXPECT_LT(centre(scene, 0) + 0.05 - (centre(scene, 1) - 0.005),
                    0.5 * 0.01 * (1. + 1e-9));
        }
        EXPECT_NEAR(velocity(scene, 0), 5. * (1. - e), 1e-8);
        EXPECT_NEAR(velocity(scene, 1), 5. * (1. + e), 1e-8);
        EXPECT_NEAR(scene.state.energy.impact, 250. * (1. - e * e), 1e-6);
      }
  }

  // what no bisection is left for is given up, not passed
  TEST(FastBodies, WhatWouldBeMissedIsRejectedWithItsLength)
  {
    Scene<2> scene(shot_and_foil, {"Time/step=9 ms"});
    try {
      scene.advance();
      FAIL();
    } catch (const StepRejected &rejected) {
      // 50 mm at 10 m/s, and an eighth of the foil
      EXPECT_NEAR(rejected.share() * 9e-3, 5e-3 + 0.125e-3, 1e-6);
      EXPECT_NE(std::string(rejected.what())
                    .find("a body of shot would fly through a body of foil"),
                std::string::npos)
          << rejected.what();
    }
    EXPECT_EQ(scene.state.time, 0.);
  }

  // a foil of four cells that deform holds a heavy shot by its inertia
  TEST(FastBodies, SoftFoilIsNotPassed)
  {
    for (const double step : {2., 9.}) {
      SCOPED_TRACE(step);
      Scene<2> scene(shot_and_foil,
                     {"Time/step=" + std::to_string(step) + " ms",
                      "Body: foil/cells=1, 4",
                      "Material: foil/model=neo-hookean",
                      "Material: foil/Young modulus=1 MPa",
                      "Material: foil/Poisson ratio=0.3"});
      const auto &cells = scene.discretization->cells();
      for (unsigned int k = 0; k < 12; ++k) {
        scene.advance_bisecting();
        double foil = 0.; // momentum of the cells: 2.5 kg, four corners each
        std::size_t n = 0;
        for (unsigned int c = 1; c < 5; ++c)
          for (std::size_t i = cells.first_node[c]; i < cells.first_node[c] + 4;
               ++i, ++n)
            foil += 2.5 / 4. * scene.state.velocity[2 * i];
        EXPECT_NEAR(foil + 10. * velocity(scene, 0), 100., 1e-6);
        EXPECT_EQ(n, 16u);
      }
      EXPECT_LT(velocity(scene, 0), 8.);
    }
  }

  TEST(FastBodies, BallsMeet)
  {
    for (const double step : {0.3, 4., 7., 20., 60.}) {
      SCOPED_TRACE(step);
      Scene<3> scene(balls, {"Time/step=" + std::to_string(step)});
      run_to(scene, 61.);
      EXPECT_NEAR(velocity(scene, 0), 0.25, 1e-9);
      EXPECT_NEAR(velocity(scene, 1), 0.25, 1e-9);
      EXPECT_LT(centre(scene, 0), centre(scene, 1));
    }
  }

  TEST(FastBodies, ThinObstacleIsNotPassed)
  {
    for (const double step : {0.7, 8., 50., 200.}) {
      SCOPED_TRACE(step);
      const std::string length = "Time/step=" + std::to_string(step) + " ms";
      // a disc stops, a disc at rest is taken along by a wire that moves
      Scene<2> thrown(wire, {length});
      run_to(thrown, 0.3);
      EXPECT_NEAR(velocity(thrown, 0), 0., 1e-9);
      EXPECT_LT(centre(thrown, 0), 0.8);
      Scene<2> swept(wire, {length, "Material: m/initial velocity x=0",
                            "Obstacle: wire/velocity x=-10"});
      run_to(swept, 0.3);
      EXPECT_NEAR(velocity(swept, 0), -10., 1e-9);
      EXPECT_LT(centre(swept, 0), 0.8 - 10. * swept.state.time);
    }
  }

  // its ends are on chords that do not come near the disc
  TEST(FastBodies, TurningRodHitsADisc)
  {
    for (const double step : {0.05, 1., 2.2}) {
      SCOPED_TRACE(step);
      Scene<2> scene(rod_and_disc, {"Time/step=" + std::to_string(step)});
      while (velocity(scene, 1) == 0. && scene.state.time < 2.4)
        scene.advance_bisecting();
      const double r = 0.05 * std::sqrt(2.), d = 0.7, half = 0.02,
                   arm = std::sqrt(d * d - (r + half) * (r + half));
      const double M = 80., I = M * (4. + 0.0016) / 12., m = 20.;
      const double P = arm / (1. / m + 1. / M + arm * arm / I);
      const double speed =
          std::hypot(velocity(scene, 1), velocity(scene, 1, 1));
      EXPECT_NEAR(m * speed, P, 0.02 * P);
      EXPECT_NEAR(m * velocity(scene, 1) + M * velocity(scene, 0), 0., 1e-9);
      EXPECT_NEAR(m * velocity(scene, 1, 1) + M * velocity(scene, 0, 1), 0.,
                  1e-9);
    }
  }
} // namespace test_fast_bodies
