#include "make_scene.h"
#include "momenta.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

// Whole steps of scenes with history-dependent materials. Momenta are computed
// here from states and masses.

using namespace nsfd;
using namespace nsfd::test;

namespace test_inelastic_motion
{
  /** A block that strains and turns, and flows soon. */
  const std::string block = R"(
set dimension = 2
set motion    = small
subsection Mesh
  set type         = rectangle
  set upper corner = 2, 1
  set cells        = 4, 2
end
subsection Material: soft
  set model                       = j2 plastic
  set Young modulus               = 100
  set Poisson ratio               = 0.3
  set density                     = 1
  set yield stress                = 2
  set isotropic hardening modulus = 5
  set kinematic hardening modulus = 10
  set initial velocity x          = 1 - 0.2 * (y - 0.5) + 0.8 * (x - 1)
  set initial velocity y          = 0.2 * (x - 1)
end
subsection Interface: all
  set law                  = elastic
  set normal stiffness     = 1e3
  set tangential stiffness = 1e3
end
subsection Time
  set end   = 1000
  set step  = 0.01
  set theta = 0.5
end
subsection Solver
  set tolerance = 1e-12
end
)";

  const std::vector<std::string> slowly = {"Material: soft/model=viscoplastic",
                                           "Material: soft/viscosity=1"};

  std::vector<std::string> with(std::vector<std::string> overrides,
                                const std::vector<std::string> &more)
  {
    overrides.insert(overrides.end(), more.begin(), more.end());
    return overrides;
  }

  template <int dim>
  void balance_closes(Scene<dim> &scene, const unsigned int n_steps)
  {
    double plastic = 0., viscous = 0.;
    for (unsigned int k = 0; k < n_steps; ++k) {
      ASSERT_LT(scene.advance().balance_residual, 1e-11) << k;
      const EnergyLines &e = scene.state.energy;
      ASSERT_GE(e.plastic, plastic);
      ASSERT_GE(e.viscous, viscous);
      plastic = e.plastic;
      viscous = e.viscous;
    }
    EXPECT_GT(plastic, 1e-3 * scene.state.initial_energy);
  }

  TEST(InelasticMotion, WithoutFlowItIsTheLinearStep)
  {
    const std::vector<std::string> firm = {"Material: soft/yield stress=1e9",
                                           "Time/theta=0.6"};
    const auto pick = [](const std::string &text, const std::string &name) {
      const std::size_t at = text.find("  set " + name);
      return text.substr(0, at) + text.substr(text.find('\n', at) + 1);
    };
    std::string linear = block;
    for (const char *name :
         {"yield stress", "isotropic hardening", "kinematic hardening"})
      linear = pick(linear, name);
    Scene<2> one(block, firm),
        other(linear,
              {"Material: soft/model=linear elastic", "Time/theta=0.6"});
    for (unsigned int k = 0; k < 100; ++k) {
      one.advance();
      other.advance();
    }
    double largest = 0.;
    for (const double u : other.state.displacement)
      largest = std::max(largest, std::abs(u));
    for (std::size_t i = 0; i < other.state.displacement.size(); ++i)
      EXPECT_NEAR(one.state.displacement[i], other.state.displacement[i],
                  1e-9 * largest);
    EXPECT_NEAR(one.state.energy.elastic, other.state.energy.elastic,
                1e-9 * other.state.initial_energy);
    EXPECT_NEAR(one.state.energy.numerical, other.state.energy.numerical,
                1e-9 * other.state.initial_energy);
    EXPECT_EQ(one.state.energy.plastic, 0.);
  }

  TEST(InelasticMotion, BalanceCloses)
  {
    for (const char *motion : {"motion=small", "motion=large"})
      for (const char *theta : {"Time/theta=0.5", "Time/theta=0.7"}) {
        SCOPED_TRACE(std::string(motion) + " " + theta);
        Scene<2> plastic(block, {motion, theta}),
            viscous(block, with(slowly, {motion, theta}));
        balance_closes(plastic, 150);
        balance_closes(viscous, 150);
        EXPECT_EQ(plastic.state.energy.viscous, 0.);
        EXPECT_GT(viscous.state.energy.viscous, 0.);
      }
  }

  TEST(InelasticMotion, LongStepsAreSolved)
  {
    for (const char *motion : {"motion=small", "motion=large"}) {
      SCOPED_TRACE(motion);
      Scene<2> scene(block, {motion, "Time/step=0.1"});
      for (unsigned int k = 0; k < 40; ++k)
        scene.advance_bisecting();
      EXPECT_GT(scene.state.energy.plastic, 0.);
    }
  }

  TEST(InelasticMotion, PlaneStress)
  {
    Scene<2> scene(block, {"plane=stress"});
    balance_closes(scene, 150);
  }

  TEST(InelasticMotion, ASecondStepFromTheSameStateIsTheSame)
  {
    for (const char *motion : {"motion=small", "motion=large"}) {
      Scene<2> scene(block, {motion});
      for (unsigned int k = 0; k < 6; ++k)
        scene.advance();
      const State start = scene.state;
      scene.advance(0.02); // in vain
      scene.state = start;
      scene.advance();
      const State first = scene.state;
      scene.state = start;
      scene.advance();
      EXPECT_EQ(scene.state.material_history, first.material_history);
      EXPECT_EQ(scene.state.displacement, first.displacement);
      EXPECT_NE(start.material_history, first.material_history);
    }
  }

  TEST(InelasticMotion, LargeMotionsKeepMomenta)
  {
    Scene<2> scene(block, {"motion=large",
                           "Material: soft/initial velocity x="
                           "1 - 2 * (y - 0.5) + 0.8 * (x - 1)",
                           "Material: soft/initial velocity y=2 * (x - 1)"});
    const auto start = momenta(scene);
    balance_closes(scene, 400);
    const auto end = momenta(scene);
    EXPECT_LT(norm(difference(end[0], start[0])), 1e-10 * norm(start[0]));
    EXPECT_LT(norm(difference(end[1], start[1])), 1e-10 * norm(start[1]));
  }

  TEST(InelasticMotion, TurnedSceneIsTheSame)
  {
    // by 170 degrees about the origin, at rest and in motion
    const std::string vx = "1 - 2 * (y - 0.5) + 0.8 * (x - 1)",
                      vy = "2 * (x - 1)";
    const std::string c = "cos(170/180 * pi)", s = "sin(170/180 * pi)",
                      at = "Material: soft/initial ";
    Scene<2> one(block, {"motion=large", at + "velocity x=" + vx,
                         at + "velocity y=" + vy}),
        other(block, {"motion=large",
                      at + "displacement x=(" + c + " - 1) * x - " + s + " * y",
                      at + "displacement y=" + s + " * x + (" + c + " - 1) * y",
                      at + "velocity x=" + c + " * (" + vx + ") - " + s +
                          " * (" + vy + ")",
                      at + "velocity y=" + s + " * (" + vx + ") + " + c +
                          " * (" + vy + ")"});
    for (unsigned int k = 0; k < 100; ++k) {
      one.advance();
      other.advance();
    }
    EXPECT_GT(one.state.energy.plastic, 0.);
    for (const auto line : {&EnergyLines::kinetic, &EnergyLines::elastic,
                            &EnergyLines::plastic, &EnergyLines::cohesive})
      EXPECT_NEAR(one.state.energy.*line, other.state.energy.*line,
                  1e-8 * one.state.initial_energy);
    ASSERT_EQ(one.state.material_history.size(),
              other.state.material_history.size());
    for (std::size_t i = 0; i < one.state.material_history.size(); ++i)
      EXPECT_NEAR(one.state.material_history[i],
                  other.state.material_history[i], 1e-8);
  }

  // Soft plastic, viscous (one modulus from place to place) and rigid cells
  // fall on a wall; the seam breaks.
  const std::string mixed = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 3, 1
  set cells        = 6, 2
end
subsection Material: soft
  set where                       = x < 1
  set model                       = j2 plastic
  set Young modulus               = 100
  set Poisson ratio               = 0.3
  set density                     = 1
  set yield stress                = 1
  set isotropic hardening modulus = 2
  set initial velocity x          = -1
end
subsection Material: elastic
  set where              = x < 2
  set Young modulus      = 100 + 40 * (x - 1)
  set shear viscosity    = 0.05
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = -1
end
subsection Material: heavy
  set model              = rigid
  set density            = 5
  set initial velocity x = -1
end
subsection Interface: seam
  set where     = abs(x - 2) < 0.01
  set law       = camacho-ortiz
  set strength  = 3
  set toughness = 0.02
end
subsection Interface: all
  set law                  = elastic
  set normal stiffness     = 1e3
  set tangential stiffness = 1e3
end
subsection Obstacle: wall
  set where    = left
  set point    = -0.1, 0
  set normal   = 1, 0
  set friction = 0.3
end
subsection Time
  set end  = 10
  set step = 0.01
end
)";

  TEST(InelasticMotion, MixedScene)
  {
    Scene<2> scene(mixed);
    double worst = 0.;
    for (unsigned int k = 0; k < 300; ++k) {
      scene.advance_bisecting();
      const EnergyLines &e = scene.state.energy;
      worst = std::max(worst, std::abs(e.kinetic + e.elastic + e.cohesive +
                                       e.damage + e.friction + e.viscous +
                                       e.plastic + e.impact + e.numerical -
                                       e.work - scene.state.initial_energy));
    }
    EXPECT_LT(worst, 1e-9 * scene.state.largest_energy);
    EXPECT_GT(scene.state.energy.plastic, 0.);
    EXPECT_GT(scene.state.energy.viscous, 0.);
    EXPECT_GT(scene.state.energy.damage, 0.);
  }

  TEST(InelasticMotion, InSpace)
  {
    const std::string text = R"(
set dimension = 3
subsection Mesh
  set type         = brick
  set upper corner = 2, 1, 1
  set cells        = 2, 1, 1
end
subsection Material: soft
  set model                       = j2 plastic
  set Young modulus               = 100
  set Poisson ratio               = 0.3
  set density                     = 1
  set yield stress                = 2
  set isotropic hardening modulus = 5
  set initial velocity x          = 0.8 * (x - 1) - 0.3 * z
  set initial velocity y          = -0.5 * y + 0.2 * z
  set initial velocity z          = 0.3 * x
end
subsection Interface: all
  set law                  = elastic
  set normal stiffness     = 1e3
  set tangential stiffness = 1e3
end
subsection Time
  set end   = 1000
  set step  = 0.02
  set theta = 0.5
end
subsection Solver
  set tolerance = 1e-12
end
)";
    for (const char *motion : {"motion=small", "motion=large"}) {
      SCOPED_TRACE(motion);
      Scene<3> scene(text, {motion});
      const auto start = momenta(scene);
      balance_closes(scene, 80);
      EXPECT_LT(norm(difference(momenta(scene)[0], start[0])), 1e-10);
    }
  }
} // namespace test_inelastic_motion
