#include "make_scene.h"

#include "time_integration/step_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

// Equilibria of cells that share their nodes, by formulas.

namespace nsfd::test_joined_statics
{
  namespace
  {
    constexpr double E = 2e9;

    std::string material(const double poisson_ratio)
    {
      return fmt::format(R"(
subsection Material: bar
  set Young modulus = 2 GPa
  set Poisson ratio = {}
  set density       = 1000
end
)",
                         poisson_ratio);
    }

    const std::string time = R"(
subsection Time
  set scheme = quasi-static
  set end    = 1
  set step   = 0.1 s
end
)";

    std::string joined(const std::string &word)
    {
      return "subsection Interface: all\n  set law = " + word + "\nend\n";
    }

    const std::string bar_mesh = R"(set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 1 m, 0.1 m
  set cells        = 10, 2
end
)";

    std::string bar(const std::string &rest)
    {
      return bar_mesh + material(0.) + rest;
    }

    const std::string pulled = R"(
subsection Boundary: left
  set displacement x = 0
end
subsection Boundary: right
  set traction x = 3 MPa * t
end
)";

    // u(L) = sigma L / E, whatever word joins the cells.
    TEST(JoinedStatics, BarInTension)
    {
      for (const std::string word : {"joined", "rigid", "bonded"}) {
        test::Scene<2> scene(bar(joined(word) + pulled + time));
        auto &statics = scene.equilibria->search();
        State state = statics.start(scene.state), next = state;
        for (unsigned int k = 1; k <= 2; ++k) {
          const auto report = statics.advance(state, 0.5 * k, next);
          EXPECT_LT(report.step.balance_residual, 1e-12);
          std::swap(state, next);
        }
        const double sigma = 3e6, area = 0.1, u = sigma / E;
        EXPECT_NEAR(*std::max_element(state.displacement.begin(),
                                      state.displacement.end()) /
                        u,
                    1., 1e-10)
            << word;
        EXPECT_NEAR(state.energy.elastic / (sigma * area * u / 2.), 1., 1e-10);
        EXPECT_NEAR(statics.reactions()[0] / (-sigma * area), 1., 1e-10);
        EXPECT_EQ(state.energy.numerical, 0.);
        for (std::size_t i = 0; i < state.kind.size(); ++i)
          if (state.kind[i] == PointKind::bonded) {
            EXPECT_LT(std::abs(state.jump[2 * i]), 1e-12 * u) << word;
          }
      }
    }

    // The same behind a rigid end of four cells, which are one body and have no
    // rows: u(L) = sigma (L - l) / E.
    TEST(JoinedStatics, BarWithARigidEnd)
    {
      const std::string stone = R"(
subsection Material: stone
  set where   = x < 0.2
  set model   = rigid
  set density = 1000
end
)";
      test::Scene<2> scene(bar_mesh + stone + material(0.) + joined("joined") +
                           pulled + time);
      auto &statics = scene.equilibria->search();
      State state = statics.start(scene.state), next = state;
      EXPECT_LT(statics.advance(state, 1., next).step.balance_residual, 1e-12);
      const double sigma = 3e6, area = 0.1, u = sigma * 0.8 / E;
      EXPECT_NEAR(*std::max_element(next.displacement.begin(),
                                    next.displacement.end()) /
                      u,
                  1., 1e-10);
      EXPECT_NEAR(next.energy.elastic / (sigma * area * u / 2.), 1., 1e-10);
      EXPECT_NEAR(statics.reactions()[0] / (-sigma * area), 1., 1e-10);
      const auto &faces = scene.discretization->points().faces;
      for (const auto &face : faces) {
        EXPECT_TRUE(face.boundary ||
                    next.kind[face.first] == PointKind::bonded);
      }
    }

    // Three planes of symmetry and a pull, each of them in one direction alone:
    // F = E e A, with lateral contraction.
    TEST(JoinedStatics, BlockOnRollers)
    {
      const double length = 8e-3, side = 12e-3, pull = 24e-6;
      test::Scene<3> scene(fmt::format(R"(set dimension = 3
subsection Mesh
  set type         = brick
  set upper corner = {0} m, {0} m, {1} m
  set cells        = 3, 2, 2
end
)",
                                       side, length) +
                           material(0.2) + joined("joined") +
                           fmt::format(R"(
subsection Boundary: left
  set displacement x = 0
end
subsection Boundary: bottom
  set displacement y = 0
end
subsection Boundary: front
  set displacement z = 0
end
subsection Boundary: back
  set displacement z = {} m * t / 1 s
end
)",
                                       pull) +
                           time);
      auto &statics = scene.equilibria->search();
      State state = statics.start(scene.state), next = state;
      const auto report = statics.advance(state, 1., next);
      EXPECT_LT(report.step.solver.newton, 12u);
      const double force = E * pull / length * side * side;
      EXPECT_NEAR(next.energy.elastic / (force * pull / 2.), 1., 1e-10);
      EXPECT_NEAR(statics.reactions()[3 * 3 + 2] / force, 1., 1e-10);
    }

    // Linear displacements on the boundary of distorted cells: plane strain of
    // uniform stress, w = lambda/2 tr(e)^2 + mu e:e.
    TEST(JoinedStatics, PatchTest)
    {
      const double nu = 0.3, a = 1e-3, b = 4e-4, c = -2e-4, d = 5e-4;
      std::string text = R"(set dimension = 2
set plane     = strain
subsection Mesh
  set type         = rectangle
  set upper corner = 1 m, 1 m
  set cells        = 5, 5
  set distortion   = 0.2
end
)" + material(nu) + joined("joined") +
                         time;
      for (const std::string side : {"left", "right", "bottom", "top"})
        text += fmt::format("subsection Boundary: {}\n"
                            "  set displacement x = ({} * x + {} * y) * t\n"
                            "  set displacement y = ({} * x + {} * y) * t\n"
                            "end\n",
                            side, a, b, c, d);
      test::Scene<2> scene(text);
      auto &statics = scene.equilibria->search();
      const State start = statics.start(scene.state);
      State next = start;
      statics.advance(start, 1., next);
      const double lambda = E * nu / ((1. + nu) * (1. - 2. * nu)),
                   mu = E / (2. * (1. + nu)), shear = (b + c) / 2.;
      const double energy = lambda / 2. * (a + d) * (a + d) +
                            mu * (a * a + d * d + 2. * shear * shear);
      EXPECT_NEAR(next.energy.elastic / energy, 1., 1e-10);
      EXPECT_NEAR(next.energy.work / energy, 1., 1e-10);
    }

    /** A bar of 20 mm with one plane that may break, to the end of @p pull. */
    struct Broken {
      double peak = 0., last = 0., missing = 0.;
      unsigned int jumps = 0;
      EnergyLines energy;
    };

    template <int dim>
    Broken break_bar(const std::string &scene)
    {
      test::Scene<dim> bar(scene);
      auto &statics = bar.equilibria->search();
      State state = statics.start(bar.state), next = state;
      StepControl control(1., 0.05, 10);
      Broken result;
      while (!control.finished()) {
        EquilibriumReport found;
        bool exists = true;
        try {
          found = statics.advance(state, control.next_time(), next,
                                  control.can_bisect());
        } catch (const StepRejected &) {
          exists = false;
        }
        if (!exists || !found.accepted()) {
          if (control.bisect())
            continue;
          if (!exists || !found.may_follow())
            throw std::runtime_error("no equilibrium");
          ++result.jumps;
        }
        control.accept();
        EXPECT_LT(found.step.balance_residual, 1e-9)
            << "t = " << control.time() << ", " << next.energy.elastic
            << " J elastic, " << next.energy.work << " J of work";
        result.missing = std::max(result.missing, state.energy.numerical -
                                                      next.energy.numerical);
        std::swap(state, next);
        result.last = statics.reactions()[dim];
        result.peak = std::max(result.peak, result.last);
      }
      result.energy = state.energy;
      return result;
    }

    template <int dim>
    std::string breaking_bar(const double toughness)
    {
      return fmt::format(R"(set dimension = {}
subsection Mesh
  set type         = {}
  set upper corner = 20 mm, 4 mm{}
  set cells        = 6, 2{}
end
{}
subsection Interface: middle
  set where     = abs(x - 10 mm) < 1 um
  set law       = camacho-ortiz
  set strength  = 10 MPa
  set toughness = {}
end
subsection Interface: elsewhere
  set law = joined
end
subsection Boundary: left
  set displacement x = 0
end
subsection Boundary: right
  set displacement x = 1 mm * t
end
{})",
                         dim, dim == 2 ? "rectangle" : "brick",
                         dim == 2 ? "" : ", 4 mm", dim == 2 ? "" : ", 2",
                         material(0.), toughness, time);
    }

    // R^2 L / (2 E G) = 0.2 < 1: elastic up to the strength, then softening
    // along the law; all of G at the end, nothing released.
    TEST(JoinedStatics, APlaneBreaksAtItsStrengthAndTakesItsToughness)
    {
      const auto check = [](const Broken &broken, const double area) {
        EXPECT_LT(broken.peak / (10e6 * area), 1. + 1e-8);
        EXPECT_GT(broken.peak / (10e6 * area), 0.99) << "the rule of peaks";
        EXPECT_LT(std::abs(broken.last), 1e-6 * broken.peak);
        EXPECT_EQ(broken.jumps, 0u);
        EXPECT_LE(broken.missing, 0.);
        EXPECT_NEAR(broken.energy.damage / (2500. * area), 1., 1e-6);
        EXPECT_NEAR(broken.energy.work / (2500. * area), 1., 1e-3)
            << "chords of the traction in load steps of finite length";
      };
      check(break_bar<2>(breaking_bar<2>(2500.)), 4e-3);
      check(break_bar<3>(breaking_bar<3>(2500.)), 16e-6);
      // points of a plane as stiff as any, soft ones and none, by multigrid
      const std::string cycles =
          "subsection Solver\n  set linear solver = cg\nend\n";
      check(break_bar<2>(breaking_bar<2>(2500.) + cycles), 4e-3);
      check(break_bar<3>(breaking_bar<3>(2500.) + cycles), 16e-6);
    }

    // R^2 L / (2 E G) = 5: at the strength the bar stores 5 G, takes one, and
    // releases four.
    TEST(JoinedStatics, ASoftBarReleasesWhatItsPlaneDoesNotTake)
    {
      const double area = 4e-3, G = 100.;
      const Broken broken = break_bar<2>(breaking_bar<2>(G));
      EXPECT_NEAR(broken.peak / (10e6 * area), 1., 1e-2);
      EXPECT_EQ(broken.jumps, 1u);
      EXPECT_NEAR(broken.energy.damage / (G * area), 1., 1e-6);
      EXPECT_NEAR(broken.energy.numerical / (4. * G * area), 1., 0.03)
          << "1 % of the load, 2 % of the energy";
      EXPECT_NEAR((broken.energy.damage + broken.energy.numerical) /
                      broken.energy.work,
                  1., 1e-9)
          << "nothing is stored any more";
    }

    TEST(JoinedStatics, DynamicsStayAtRestAfterTheStart)
    {
      test::Scene<2> scene(bar(joined("bonded") + R"(
subsection Boundary: left
  set displacement x = 0
end
subsection Boundary: right
  set traction x = 3 MPa
end
subsection Time
  set start = equilibrium
  set end   = 1 ms
  set step  = 0.5 courant
end
)"));
      scene.state = scene.equilibria->search().start(scene.state);
      const double sigma = 3e6, area = 0.1;
      EXPECT_NEAR(scene.state.energy.elastic / (sigma * area * sigma / E / 2.),
                  1., 1e-10);
      for (unsigned int k = 0; k < 50; ++k) {
        scene.advance();
        EXPECT_LT(scene.state.energy.kinetic,
                  1e-14 * scene.state.energy.elastic);
      }
    }

    TEST(JoinedStatics, WhatNothingHoldsIsNamed)
    {
      test::Scene<2> loose(bar(joined("joined") + time +
                               "subsection Loads\n  set gravity = 0, -9.81\n"
                               "end\n"));
      try {
        loose.equilibria->search().start(loose.state);
        ADD_FAILURE() << "has no equilibrium";
      } catch (const StepRejected &rejected) {
        EXPECT_NE(std::string(rejected.what()).find("translation in y"),
                  std::string::npos)
            << rejected.what();
      }
    }
  } // namespace
} // namespace nsfd::test_joined_statics
