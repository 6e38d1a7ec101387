#include "held_scenes.h"
#include "make_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// Joints, pins and supports of large motions, whose rows depend on each other.

using namespace nsfd;
using namespace nsfd::test;

namespace test_held_rows
{
  /** Some cells, all of them if the condition is true, do not strain. */
  std::string with_rigid(std::string text, const std::string &where)
  {
    const std::string rigid = "subsection Material: r\n  set where = " + where +
                              "\n  set model = rigid\n"
                              "  set density = 1000\nend\n";
    return text.insert(text.find("subsection Material: m"), rigid);
  }

  TEST(HeldRows, DrivenJointsDoNoWork)
  {
    // while the block has hardly moved it is that of small motions
    for (const double step : {5e-3, 5e-4}) {
      Scene<2> large(driven),
          small(driven, {"motion=small", "Material: m/model=linear elastic"});
      while (large.state.time < 0.08 - step / 2.) {
        large.advance(step);
        small.advance(step);
      }
      const auto &energy = large.state.energy;
      EXPECT_NEAR(energy.work, small.state.energy.work, 1e-4 * energy.work);
      EXPECT_LT(std::abs(energy.impact), 1e-9 * energy.work);
      EXPECT_LT(std::abs(energy.numerical), 1e-7 * energy.work);
    }
  }

  TEST(HeldRows, DrivenJointsOfRigidCells)
  {
    const std::vector<std::string> wave = {
        "Boundary: head/velocity x=0.3 * sin(t)",
        "Boundary: head/velocity y=0.1 * sin(3 * t)"};
    for (const char *const where : {"true", "x > 0.3 && x < 0.7"}) {
      SCOPED_TRACE(where);
      Scene<2> scene(
          where == std::string("true")
              ? [] {
                  std::string text = driven;
                  const auto at = text.find("  set model"),
                             end = text.find("  set density");
                  return text.replace(at, end - at, "  set model = rigid\n");
                }()
              : with_rigid(driven, where),
          wave);
      for (unsigned int k = 0; k < 1000; ++k) {
        scene.advance();
        const double t = scene.state.time,
                     v[2] = {0.3 * std::sin(t), 0.1 * std::sin(3. * t)};
        const auto &points = scene.discretization->points();
        for (std::size_t i = 0; i < points.n_points; ++i)
          for (unsigned int c = 0; c < 2; ++c)
            ASSERT_NEAR(scene.state.relative_velocity[2 * i + c],
                        scene.discretization->origins()[i].kind ==
                                PointOrigin::Kind::motion
                            ? v[c]
                            : 0.,
                        1e-6)
                << "step " << k;
      }
      EXPECT_LT(std::abs(scene.state.energy.impact), 1e-9);
      EXPECT_LT(scene.state.rigid_drift, 1e-8);
    }
  }

  TEST(HeldRows, DrivenJointsStopAtOnce)
  {
    // one square metre of 1000 kg/m^3, at a speed that jumps within round-off
    // of the end of a step
    std::string text = driven;
    const auto at = text.find("  set model"), end = text.find("  set density");
    text.replace(at, end - at, "  set model = rigid\n");
    Scene<2> scene(text, {"Boundary: head/velocity x=if(t < 0.1, 2, 0)",
                          "Boundary: head/velocity y=0.5"});
    for (unsigned int k = 0; k < 40; ++k) {
      scene.advance();
      const double snapped = 5e-3 * (k + 1); // as a run has it
      scene.state.time = snapped;
      if (snapped < 0.099) {
        EXPECT_NEAR(scene.state.energy.kinetic, 2125., 1e-3);
      } else if (snapped > 0.106) {
        EXPECT_NEAR(scene.state.energy.kinetic, 125., 1e-3);
      }
    }
  }

  // --- what is joined begins apart

  const std::string apart = R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set upper corner = 2, 1
  set cells        = 2, 1
end
subsection Material: a
  set where              = x < 1
  set model              = rigid
  set density            = 1000
  set initial velocity x = 1
end
subsection Material: b
  set model   = rigid
  set density = 1000
end
subsection Interface: joined
  set law = rigid
end
subsection Time
  set end  = 2
  set step = 5 ms
end
)";

  TEST(HeldRows, JointsThatBeginApartMeetOnce)
  {
    // two equal bodies: half of 500 J
    Scene<2> scene(apart);
    for (unsigned int k = 0; k < 20; ++k) {
      scene.advance();
      EXPECT_NEAR(scene.state.energy.impact, 250., 1e-6);
      EXPECT_NEAR(scene.state.energy.kinetic, 250., 1e-6);
      for (const double U : scene.state.relative_velocity)
        EXPECT_NEAR(U, 0., 1e-7);
    }
  }

  TEST(HeldRows, CellsThatBeginApartMeetOnce)
  {
    std::string text = apart;
    for (unsigned int k = 0; k < 2; ++k) {
      const auto at = text.find("= rigid\n", text.find("subsection Material"));
      text.replace(at, 7,
                   "= neo-hookean\n  set Young modulus = 1e6\n"
                   "  set Poisson ratio = 0.3");
    }
    Scene<2> scene(text, {"Material: a/initial velocity y=0.5"});
    double impact = 0.;
    for (unsigned int k = 0; k < 200; ++k) {
      scene.advance();
      if (k == 0) {
        impact = scene.state.energy.impact;
        EXPECT_GT(impact, 0.);
        EXPECT_LT(impact, 625. / 2.); // what is left moves on
      }
      EXPECT_NEAR(scene.state.energy.impact, impact, 1e-6);
      EXPECT_NEAR(scene.energy() + impact, 625., 1e-4);
      for (const double U : scene.state.relative_velocity)
        EXPECT_NEAR(U, 0., 1e-6);
    }
  }

  TEST(HeldRows, PinStopsWhereItIsHeld)
  {
    // a square of one kilogram, I = (1 + 1) / 12 about its middle, thrown past
    // a pin 1/2 below it: omega (I + 1/4) = - 1/2
    const std::string text = R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set upper corner = 1, 1
  set cells        = 1, 1
end
subsection Material: a
  set model              = rigid
  set density            = 1
  set initial velocity x = 1
end
subsection Interface: all
  set law = rigid
end
subsection Pin: foot
  set material = a
  set at       = 0.5, 0
end
subsection Time
  set end  = 1
  set step = 0.1 ms
end
)";
    Scene<2> scene(text);
    const double omega = -0.5 / (1. / 6. + 0.25);
    for (unsigned int k = 0; k < 100; ++k) {
      scene.advance();
      // first order in the step that takes the velocity of the pin away
      EXPECT_NEAR(scene.state.rigid[12], omega, 1e-3);
    }
    EXPECT_NEAR(scene.state.energy.kinetic, 0.5 * omega * omega * (5. / 12.),
                1e-3);
    EXPECT_NEAR(scene.state.energy.kinetic + scene.state.energy.impact, 0.5,
                1e-9);
  }

  // --- rest

  /** A table of rigid cells on three feet, each of which is held at both of
      its ends: more rows than the scene has unknowns. */
  const std::string table = R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set upper corner = 0.3, 0.2
  set cells        = 3, 2
end
subsection Material: m
  set model   = rigid
  set density = 800
end
subsection Interface: joined
  set law = rigid
end
subsection Boundary: feet
  set where      = bottom
  set velocity x = 0
  set velocity y = 0
end
subsection Loads
  set gravity = 0, -9.81 m/s^2
end
subsection Time
  set end  = 1
  set step = 1 ms
end
)";

  TEST(HeldRows, RestIsRest)
  {
    // places of free fall in a step are g h^2: a tolerance of that per step
    constexpr double fall = 9.81e-6, tolerance = 1e-8;
    constexpr unsigned int n_steps = 500;
    for (const bool soft : {false, true}) {
      SCOPED_TRACE(soft ? "with soft cells" : "rigid");
      const std::string text =
          soft ? [] {
            std::string mixed = table;
            return mixed.insert(mixed.find("subsection Material: m"),
                                "subsection Material: s\n  set where = y < 0.1\n"
                                "  set model = saint-venant kirchhoff\n"
                                "  set Young modulus = 1e12\n"
                                "  set Poisson ratio = 0\n"
                                "  set density = 800\nend\n");
          }()
               : table;
      Scene<2> scene(text);
      for (unsigned int k = 0; k < n_steps; ++k)
        scene.advance();
      // what is soft sinks by rho g l^2 / E, times two as it is let go
      const double sinks = soft ? 2. * 800. * 9.81 * 0.2 * 0.1 / 1e12 : 0.;
      for (const double u : scene.state.displacement)
        EXPECT_LT(std::abs(u), sinks + n_steps * tolerance * fall);
      EXPECT_LT(std::abs(scene.state.energy.impact),
                tolerance * 800. * 0.06 * 9.81 * fall * n_steps);
    }
  }

  // --- joints, supports and contacts of meshes that do not match

  TEST(HeldRows, PressedBlocks)
  {
    // a strain of 1e-3 of 1 GPa over 20 mm
    Scene<2> scene(pressed,
                   {"Boundary: head/velocity y=if(t < 1 ms, -0.1, 0)"});
    while (scene.state.time < 2e-3)
      scene.advance();
    const auto &force = scene.stepper->reactions();
    ASSERT_EQ(force.size(), 4u);
    EXPECT_NEAR(force[1], 2e4, 0.03 * 2e4);
    EXPECT_NEAR(force[3], -2e4, 0.03 * 2e4);
    EXPECT_LT(std::abs(scene.state.energy.impact), 1e-2);
    EXPECT_NEAR(scene.state.energy.elastic, 1., 0.03); // F^2 L / (2 E A)
  }

  TEST(HeldRows, DraggedBlock)
  {
    for (const double friction : {0.5, 0.}) {
      SCOPED_TRACE(friction);
      Scene<2> scene(dragged,
                     {"Contact: slide/friction=" + std::to_string(friction)});
      double along = 0., across = 0.;
      for (unsigned int k = 0; k < 300; ++k) {
        scene.advance();
        if (scene.state.time < 0.4e-3)
          continue; // it is set in motion
        along += scene.stepper->reactions()[0];
        across += scene.stepper->reactions()[1];
      }
      EXPECT_GT(across, 0.);
      // the base is at rest but for what waves take and bring
      EXPECT_NEAR(-along, friction * across, 0.02 * across);
    }
  }
} // namespace test_held_rows
