#include "make_scene.h"

#include "time_integration/common_balance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

// Energy and momentum over whole steps. Balances are computed here from
// states, matrices and impulses, not taken from the energy balance that they
// check.

using namespace nsfd;
using nsfd::test::Scene;

namespace test_conservation
{
  using Vector = std::vector<double>;

  double dot(const Vector &a, const Vector &b)
  {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.);
  }

  // --- an elastic pulse through intact faces

  /** Stiffness C = C L/E (L = E = 1), strength out of reach. */
  const std::string pulse = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 8, 4
  set cells        = 8, 4
end
subsection Material: plate
  set model              = linear elastic
  set Young modulus      = 1
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = exp(-((x - 2)^2 + (y - 1.5)^2))
  set initial velocity y = 0.5 * exp(-((x - 5)^2 + (y - 2)^2))
end
subsection Interface: all
  set law       = michel-suquet
  set stiffness = 21
  set strength  = 1e9
end
subsection Time
  set end   = 1000
  set step  = 0.5 courant
  set theta = 0.5
end
subsection Solver
  set tolerance = 1e-10
end
)";

  std::vector<std::string> stiffness(const std::string &C)
  {
    return {"Interface: all/stiffness=" + C};
  }

  std::vector<std::string> operator+(std::vector<std::string> a,
                                     const std::vector<std::string> &b)
  {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  }

  template <int dim>
  void conserves(const std::string &text,
                 const std::vector<std::string> &overrides,
                 const unsigned int n_steps)
  {
    Scene<dim> scene(text, overrides);
    const double energy = scene.energy();
    double largest = 0.;
    for (unsigned int step = 0; step < n_steps; ++step) {
      scene.advance();
      largest = std::max(largest, std::abs(scene.energy() - energy));
    }
    ASSERT_GT(scene.state.energy.cohesive, 0.);
    EXPECT_EQ(scene.state.energy.damage, 0.);
    // The identity holds at a solution: a residual of 1e-10 costs up to that
    // share of the energy that passes the faces in a step.
    EXPECT_LE(largest, 1e-9 * energy);
  }

  TEST(Conservation, ExactRuleKeepsTheEnergy)
  {
    for (const std::string C : {"21", "1e3", "1e5", "1e8"}) {
      SCOPED_TRACE("C L/E = " + C);
      conserves<2>(pulse, stiffness(C), 100);
    }
  }

  TEST(Conservation, ExactRuleKeepsTheEnergyOfAShock)
  {
    // A jump of velocities at faces so stiff that u = T / C is 1e-8 of the
    // motion h U: the traction must not come from a difference of jumps, or
    // the round-off of 1e-16 C h U ends the iteration above the tolerance.
    std::string shock = pulse;
    const std::string smooth =
        shock.substr(shock.find("  set initial velocity x"),
                     shock.find("end\nsubsection Interface") -
                         shock.find("  set initial velocity x"));
    shock.replace(shock.find(smooth), smooth.size(), "");
    shock += R"(
subsection Material: struck
  set where              = x > 4 && y < 2
  set model              = linear elastic
  set Young modulus      = 1
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = -1
end
)";
    // the first block whose `where` holds owns a cell
    shock.replace(shock.find("Material: plate\n"), 16,
                  "Material: plate\n  set where = x < 4 || y > 2\n");
    for (const std::string C : {"21", "1e3", "1e5", "1e8"}) {
      SCOPED_TRACE("C L/E = " + C);
      conserves<2>(shock,
                   stiffness(C) +
                       std::vector<std::string>{"Solver/tolerance=1e-12"},
                   100);
    }
  }

  TEST(Conservation, ExactRuleKeepsTheEnergyAtLongSteps)
  {
    for (const std::string step : {"0.05", "2", "20"})
      for (const std::string C : {"21", "1e5"}) {
        SCOPED_TRACE("C L/E = " + C + ", step " + step);
        conserves<2>(
            pulse,
            stiffness(C) +
                std::vector<std::string>{"Time/step=" + step + " courant",
                                         step == "20" ? "Solver/path=assembled"
                                                      : "Solver/path=local"},
            50);
      }
  }

  TEST(Conservation, ExactRuleKeepsTheEnergyOnOtherElements)
  {
    conserves<2>(pulse, {"Discretization/degree=2", "Mesh/cells=4, 2"}, 50);
    conserves<2>(pulse,
                 {"Mesh/type=crossed triangles", "Mesh/distortion=0.2",
                  "Mesh/cells=4, 2"},
                 50);
    conserves<2>(
        pulse, {"Mesh/distortion=0.2", "Interface: all/tangential stiffness=4"},
        50);
    const std::vector<std::string> solid = {"dimension=3",
                                            "Mesh/lower corner=0, 0, 0",
                                            "Mesh/upper corner=4, 2, 2"};
    conserves<3>(pulse,
                 solid + std::vector<std::string>{"Mesh/type=brick",
                                                  "Mesh/cells=3, 2, 2"},
                 30);
    conserves<3>(pulse,
                 solid + std::vector<std::string>{"Mesh/type=tetrahedra",
                                                  "Mesh/cells=2, 1, 1"},
                 30);
  }

  TEST(Conservation, OtherRulesDecay)
  {
    // At C L/E = 21 the faces hold percents of the energy, at 1e8 1e-8 of it;
    // the share lost in 100 steps follows.
    for (const std::string rule : {"end point", "end velocity"}) {
      double last_loss = 1.;
      for (const std::string C : {"21", "1e3", "1e5"}) {
        SCOPED_TRACE(rule + ", C L/E = " + C);
        Scene<2> scene(pulse, stiffness(C) + std::vector<std::string>{
                                                 "Time/cohesion rule=" + rule});
        const double energy = scene.energy();
        for (unsigned int step = 0; step < 100; ++step)
          scene.advance();
        const double loss = (energy - scene.energy()) / energy;
        EXPECT_GT(loss, 1e-5);
        EXPECT_LT(loss, 0.5 * last_loss);
        // what is lost is named
        EXPECT_NEAR(scene.state.energy.numerical, loss * energy, 1e-9 * energy);
        last_loss = loss;
      }
    }
  }

  TEST(Conservation, EndPointLosesTheSquareOfTheStep)
  {
    // R.(u'-u) = d psi + du.C du / 2: at theta = 1/2 nothing else is lost
    Scene<2> scene(pulse, {"Time/cohesion rule=end point",
                           "Interface: all/tangential stiffness=4"});
    const auto &points = scene.discretization->points();
    for (unsigned int step = 0; step < 30; ++step) {
      const double before = scene.energy();
      scene.advance();
      double loss = 0.;
      for (std::size_t i = 0; i < points.n_points; ++i) {
        const double du_N = scene.state.jump[2 * i] - scene.next.jump[2 * i],
                     du_T = scene.state.jump[2 * i + 1] -
                            scene.next.jump[2 * i + 1];
        loss += points.weight[i] * (21. * du_N * du_N + 4. * du_T * du_T) / 2.;
      }
      EXPECT_GT(loss, 0.);
      EXPECT_NEAR(before - scene.energy(), loss, 1e-9 * before);
    }
  }

  TEST(Conservation, Momentum)
  {
    // sum of m v and of m x cross v; rigid motions open no face
    Scene<2> scene(pulse, {"Mesh/distortion=0.2"});
    const auto &discretization = *scene.discretization;
    const auto mode = [&](const unsigned int k) {
      return discretization.interpolate(
          [k](const dealii::Point<2> &x, const unsigned int, double *v) {
            v[0] = k == 0 ? 1. : k == 1 ? 0. : -x[1];
            v[1] = k == 0 ? 0. : k == 1 ? 1. : x[0];
          });
    };
    const Vector modes[] = {mode(0), mode(1), mode(2)};
    const auto momentum = [&](const unsigned int k) {
      Vector Mv(scene.state.velocity.size());
      scene.delassus->apply(DelassusOperator<2>::Operator::mass,
                            scene.state.velocity.data(), Mv.data());
      return dot(modes[k], Mv);
    };
    const double start[] = {momentum(0), momentum(1), momentum(2)};
    EXPECT_GT(start[0], 1.) << "the pulse moves";
    for (unsigned int step = 0; step < 100; ++step)
      scene.advance();
    // action and reaction are the same number: round-off of 100 steps
    for (unsigned int k = 0; k < 3; ++k)
      EXPECT_NEAR(momentum(k), start[k], 1e-12 * start[0] * (k == 2 ? 8. : 1.));
  }

  // --- the balance of a step

  /**
   * Everything at once: loads, a driven side, friction, impacts, fracture. One
   * point per face keeps W regular, so that no step is a hard one.
   */
  const std::string everything = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 4, 3
  set cells        = 4, 3
  set distortion   = 0.2
end
subsection Discretization
  set interface points = 1
end
subsection Material: plate
  set model              = linear elastic
  set Young modulus      = 100
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = 0.8 * sin(4 * x) + 0.5 * sin(3 * y)
  set initial velocity y = 0.6 * sin(3 * x) - 0.3 * (y - 1.5)
  set body force x       = sin(5 * t) * y
end
subsection Interface: all
  set law              = michel-suquet
  set stiffness        = 2000
  set strength         = 4
  set strength scatter = 0.3
  set friction         = 0.4
  set restitution      = 0.2
end
subsection Boundary: left
  set velocity x = 0.3 * sin(10 * t)
end
subsection Boundary: right
  set traction y = 0.5 * cos(7 * t)
end
subsection Obstacle: floor
  set where       = bottom
  set point       = 0, -0.01
  set normal      = 0, 1
  set friction    = 0.3
  set restitution = 0.3
end
subsection Loads
  set gravity = 0, -1
end
subsection Time
  set end   = 1000
  set step  = 0.05 courant
end
)";

  TEST(Conservation, EnergyIdentityOfAStep)
  {
    // E' - E = P.U_theta + h F.v_theta
    //          - (theta - 1/2) (|dv|_M^2 + |dq|_K^2),  whatever P is
    for (const std::string theta : {"0.5", "0.6", "1"})
      for (const std::string rule : {"exact", "end point", "end velocity"}) {
        SCOPED_TRACE("theta = " + theta + ", " + rule);
        Scene<2> scene(everything,
                       {"Time/theta=" + theta, "Time/cohesion rule=" + rule});
        const double th = std::stod(theta);
        const std::size_t n = scene.discretization->bodies().n_dofs();
        using Operator = DelassusOperator<2>::Operator;
        const auto apply = [&](const Operator op, const Vector &x) {
          Vector y(n);
          scene.delassus->apply(op, x.data(), y.data());
          return y;
        };
        const auto energy = [&](const State &state) {
          return (dot(state.velocity, apply(Operator::mass, state.velocity)) +
                  dot(state.displacement,
                      apply(Operator::stiffness, state.displacement))) /
                 2.;
        };
        double largest = energy(scene.state);
        for (unsigned int step = 0; step < 60; ++step) {
          const double h = scene.advance_bisecting();
          const State &now = scene.state, &old = scene.next;
          double work = 0.;
          for (std::size_t k = 0; k < now.impulse.size(); ++k)
            work += now.impulse[k] * (th * now.relative_velocity[k] +
                                      (1. - th) * old.relative_velocity[k]);
          Vector F(n, 0.), dv(n), dq(n), v_theta(n);
          scene.discretization->add_loads(old.time + th * h, F);
          for (std::size_t i = 0; i < n; ++i) {
            dv[i] = now.velocity[i] - old.velocity[i];
            dq[i] = now.displacement[i] - old.displacement[i];
            v_theta[i] = th * now.velocity[i] + (1. - th) * old.velocity[i];
          }
          work += h * dot(F, v_theta);
          const double scheme =
              (th - 0.5) * (dot(dv, apply(Operator::mass, dv)) +
                            dot(dq, apply(Operator::stiffness, dq)));
          largest = std::max(largest, energy(now));
          EXPECT_NEAR(energy(now) - energy(old), work - scheme, 1e-12 * largest)
              << "step " << step;
        }
        EXPECT_GT(scene.state.energy.damage, 0.);
        EXPECT_GT(scene.state.energy.friction, 0.);
        EXPECT_NE(scene.state.energy.impact, 0.);
        EXPECT_NE(scene.state.energy.work, 0.);
      }
  }

  TEST(Conservation, BalanceClosesAndItsLinesHaveTheirSigns)
  {
    for (const std::string theta : {"0.5", "0.7"})
      for (const std::string other : {"Interface: all/friction=0.4",
                                      "Discretization/interface points=2"}) {
        SCOPED_TRACE("theta = " + theta + ", " + other);
        std::vector<std::string> overrides = {"Time/theta=" + theta, other,
                                              "Solver/tolerance=1e-10"};
        if (other.back() == '2')
          overrides.push_back("Interface: all/friction=0");
        Scene<2> scene(everything, overrides);
        for (unsigned int step = 0; step < 150; ++step) {
          const State before = scene.state;
          scene.advance_bisecting();
          const State &now = scene.state;
          const EnergyLines &e = now.energy;
          // 1e-12: round-off over all points and steps; required are 1e-9
          EXPECT_NEAR(e.kinetic + e.elastic + e.cohesive + e.damage +
                          e.friction + e.impact + e.numerical - e.work,
                      now.initial_energy, 1e-12 * now.largest_energy)
              << "step " << step;
          EXPECT_GE(now.energy.damage, before.energy.damage);
          // theta below 1 / (1 + e) = 0.77: impacts only lose, or nothing to
          // the tolerance of the solver where a contact stays closed
          EXPECT_GE(now.energy.impact,
                    before.energy.impact - 1e-9 * now.largest_energy);
          for (std::size_t i = 0; i < now.beta.size(); ++i) {
            ASSERT_LE(now.beta[i], before.beta[i]) << "damage healed";
            ASSERT_GE(now.opening_max[i], before.opening_max[i]);
          }
        }
        EXPECT_GE(scene.state.positive_friction_work, 0.);
        EXPECT_GT(scene.state.energy.damage, 0.01 * scene.state.initial_energy);
      }
  }

  TEST(Conservation, NothingIsLostToTheScheme)
  {
    // theta = 1/2 and the exact rule: besides damage, friction and impacts
    // only the overlap of springs that turn into contacts is dropped, and that
    // once per point. Unilateral from the start: not even that.
    Scene<2> scene(everything, {"Interface: all/intact faces=unilateral",
                                "Solver/tolerance=1e-11"});
    for (unsigned int step = 0; step < 100; ++step)
      scene.advance_bisecting();
    EXPECT_GT(scene.state.energy.damage, 0.01 * scene.state.initial_energy);
    EXPECT_NEAR(scene.state.energy.numerical, 0.,
                1e-9 * scene.state.largest_energy);
  }
} // namespace test_conservation
