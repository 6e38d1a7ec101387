#include "make_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

// Equilibria by formulas. Balance is found to 1e-10 of the forces; over N cells
// in a row the stress is right to N times that.

namespace nsfd::test_quasi_static
{
  namespace
  {
    /** A scene and its equilibria, in 2 or 3 dimensions. */
    template <int dim>
    struct Statics {
      test::Scene<dim> scene;
      EquilibriumSearch<dim> &quasi_static;
      State state, next;

      explicit Statics(const std::string &text,
                       const std::vector<std::string> &set = {})
          : scene(text, set), quasi_static(scene.equilibria->search()),
            state(scene.state), next(state)
      {
      }

      void start() { state = quasi_static.start(state); }
      EquilibriumReport to(const double time)
      {
        const auto report = quasi_static.advance(state, time, next);
        std::swap(state, next);
        return report;
      }
    };

    const std::string materials = R"(
subsection Material: bar
  set Young modulus = 2 GPa
  set Poisson ratio = 0
  set density       = 1000
end
)";
    const std::string time = R"(
subsection Time
  set scheme = quasi-static
  set end    = 1
  set step   = 0.1 s
end
)";
    const std::string bar = R"(set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 1 m, 0.1 m
  set cells        = 10, 1
end
)" + materials;
    const std::string springs = R"(
subsection Interface: springs
  set law                  = elastic
  set normal stiffness     = 1e11
  set tangential stiffness = 1e11
end
)";

    // u(L) = sigma (L/E + 9/C): nine springs between ten cells.
    TEST(QuasiStatic, BarIsStretchedByItsTraction)
    {
      Statics<2> bar_2(bar + springs + time + R"(
subsection Boundary: left
  set displacement x = 0
end
subsection Boundary: right
  set traction x = 3 MPa * t
end
)");
      bar_2.start();
      for (unsigned int k = 1; k <= 4; ++k) {
        const auto report = bar_2.to(0.25 * k);
        EXPECT_LT(report.step.balance_residual, 1e-9);
        EXPECT_FALSE(report.jumps);
      }
      const double sigma = 3e6, A = 0.1;
      const double u = sigma * (1. / 2e9 + 9. / 1e11);
      const auto &e = bar_2.state.energy;
      EXPECT_NEAR(2. * (e.elastic + e.cohesive) / (sigma * A) / u, 1., 1e-9);
      EXPECT_NEAR(e.work / (sigma * A * u / 2.), 1., 1e-9)
          << "the mean traction works";
      EXPECT_LT(std::abs(e.numerical), 1e-10 * e.work)
          << "what the balance leaves over, no term of the step";
      EXPECT_NEAR(bar_2.quasi_static.reactions()[0] / (-sigma * A), 1., 1e-9);
    }

    TEST(QuasiStatic, DynamicsStayAtRestAfterTheStart)
    {
      Statics<2> held(bar + springs + R"(
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
)");
      held.start();
      auto &scene = held.scene;
      scene.state = held.state;
      for (unsigned int k = 0; k < 50; ++k) {
        scene.advance();
        EXPECT_LT(scene.state.energy.kinetic,
                  1e-14 * scene.state.energy.elastic)
            << "ten cells, 1e-8 of the forces per dynamic step, squared";
      }
      EXPECT_NEAR(scene.state.energy.elastic / held.state.energy.elastic, 1.,
                  1e-8);
    }

    // The gap g closes, then the bar is pressed: sigma = E (U - g)/L.
    TEST(QuasiStatic, ABarClosesItsGapInOneStep)
    {
      Statics<3> pressed(R"(set dimension = 3
subsection Mesh
  set type         = brick
  set upper corner = 1 m, 0.2 m, 0.2 m
  set cells        = 4, 1, 1
end
)" + materials + R"(
subsection Interface: all
  set law = rigid
end
subsection Obstacle: wall
  set where  = right
  set point  = 1.001 m, 0, 0
  set normal = -1, 0, 0
end
subsection Boundary: left
  set displacement x = 3 mm * t
  set displacement y = 0
  set displacement z = 0
end
)" + time);
      pressed.start();
      pressed.to(0.3);
      EXPECT_LT(pressed.state.energy.elastic, 1e-12) << "the gap is open";
      const auto report = pressed.to(1.);
      EXPECT_LT(report.step.balance_residual, 1e-9);
      EXPECT_NEAR(pressed.quasi_static.reactions()[0] / (2e9 * 0.002 * 0.04),
                  1., 1e-9);
      EXPECT_LT(pressed.state.penetration, 1e-12);
    }

    const std::string block = R"(set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 2 m, 1 m
  set cells        = 4, 2
end
)" + materials + R"(
subsection Interface: all
  set law = rigid
end
subsection Obstacle: floor
  set where    = bottom
  set point    = 0, 0
  set normal   = 0, 1
  set friction = 0.5
end
subsection Boundary: top
  set pressure   = 1e5
  set traction x = 1e5 * t
end
)" + time;

    // mu p = 5e4 Pa: it holds below t = 1/2, and nothing does above.
    TEST(QuasiStatic, FrictionHoldsUpToItsBound)
    {
      Statics<2> pushed(block);
      pushed.start();
      double push = 0., last = 0.;
      for (const double t : {0.2, 0.4, 0.49}) {
        const auto report = pushed.to(t);
        EXPECT_LT(report.step.balance_residual, 1e-9);
        // as long as all sticks, what is left is the round-off of the jumps
        EXPECT_GE(pushed.state.energy.friction,
                  last - 1e-12 * pushed.state.energy.elastic)
            << "friction takes";
        last = pushed.state.energy.friction;
        push = 0.;
        const auto &origins = pushed.scene.discretization->origins();
        for (std::size_t i = 0; i < origins.size(); ++i)
          if (origins[i].kind == PointOrigin::Kind::obstacle) {
            const double N = pushed.state.point_force[2 * i],
                         T = pushed.state.point_force[2 * i + 1];
            push += std::abs(T);
            EXPECT_LE(std::abs(T), 0.5 * N + 1e-8 * 1e5);
          }
        EXPECT_NEAR(push / (2e5 * t), 1., 1e-8);
      }
      try {
        pushed.to(0.51);
        ADD_FAILURE() << "mu N = 1e5 N/m holds 1.02e5";
      } catch (const StepRejected &rejected) {
        EXPECT_NE(std::string(rejected.what()).find("translation in x"),
                  std::string::npos)
            << rejected.what();
      }
    }

    TEST(QuasiStatic, WhatNothingHoldsIsNamed)
    {
      const std::string free_bar = bar + springs + time;
      const std::pair<std::string, std::string> loads[] = {
          {"subsection Loads\n  set gravity = 0, -9.81\nend\n",
           "translation in y"},
          {"subsection Boundary: top\n  set traction x = 1e3\nend\n"
           "subsection Boundary: bottom\n  set traction x = -1e3\nend\n",
           "rotation about z"}};
      for (const auto &[load, motion] : loads) {
        Statics<2> loose(free_bar + load);
        try {
          loose.start();
          ADD_FAILURE() << load << "has no equilibrium";
        } catch (const StepRejected &rejected) {
          EXPECT_NE(std::string(rejected.what()).find(motion),
                    std::string::npos)
              << rejected.what();
        }
      }
    }

    // U = u + T(u)/k, k = 1.5 C: behind the peak T is concave, and the mean of
    // the reactions over a step is less than the grip has to give. What it gave
    // is what bar and face have taken, (T^2 - R_max^2)/(2 k) + I(u) - I(d_c)
    // per area. At U = (1 + 2/3 + 1) d_c, u^2 + u d_c = 8 d_c^2.
    TEST(QuasiStatic, SofteningCreatesNoEnergyInStepsOfAnyLength)
    {
      const std::string softening = R"(set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 20 mm, 5 mm
  set cells        = 2, 1
end
subsection Discretization
  set interface points = 1
end
subsection Material: bar
  set Young modulus = 1.5e12 * 20 mm
  set Poisson ratio = 0
  set density       = 2000
end
subsection Interface: middle
  set law       = michel-suquet
  set stiffness = 1e12 Pa/m
  set strength  = 5 MPa
end
subsection Boundary: left
  set displacement x = 0
end
subsection Boundary: right
  set displacement x = 5 um * (1 + 1/1.5 + t)
end
)" + time;
      const double C = 1e12, d_c = 5e-6, area = 5e-3;
      const double x = (std::sqrt(33.) - 1.) / 2., y = x - 1.;
      const double T = x * (3. - x) / (1. + x); // over C d_c, as d over d_c
      const double taken = area * C * d_c * d_c *
                           ((T * T - 1.) / (2. * 1.5) + y * (3. - y / 2.) -
                            4. * std::log1p(y / 2.));
      for (const unsigned int n : {10, 40}) {
        Statics<2> pulled(softening);
        pulled.start(); // at the peak: behind it the law is smooth
        for (unsigned int step = 1; step <= n; ++step) {
          const auto report = pulled.to(double(step) / n);
          EXPECT_TRUE(report.accepted());
          EXPECT_LT(report.step.balance_residual, 1e-9);
        }
        EXPECT_GE(pulled.state.energy.numerical, 0.);
        EXPECT_LT(pulled.state.energy.numerical, 1e-9 * taken);
        EXPECT_NEAR(pulled.state.energy.work / taken, 1., 1e-8);
      }
    }
  } // namespace
} // namespace nsfd::test_quasi_static
