// Bodies at rest on more contacts than they need: errors of steps add up.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

using namespace nsfd;
using namespace nsfd::test;

namespace test_rest
{
  /** By how much a free fall would be off in a step if its impulses were off by
      that much: ten steps until all rest, solved to the tolerance of the
      solver, then to round-off. */
  double allowed(const unsigned int n_steps, const double fall)
  {
    return fall * (10. * 1e-8 + n_steps * 1e-14);
  }

  const std::string wall = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 10, 1
  set cells        = 10, 10
end
subsection Material: blocks
  set model   = rigid
  set density = 1000
end
subsection Interface: joints
  set law      = contact
  set friction = 0.6
end
subsection Obstacle: floor
  set where    = bottom
  set point    = 0, 0
  set normal   = 0, 1
  set friction = 0.6
end
subsection Loads
  set gravity = 0, -10
end
subsection Time
  set end   = 100
  set step  = 10 ms
  set theta = 0.5
end
)";

  // dry joints with friction on all sides, twice as many rows as unknowns. It
  // had crept by 5e-8 of g h^2 in every step, and more slowly at each
  TEST(Rest, WallDoesNotCreep)
  {
    Scene<2> scene(wall);
    constexpr unsigned int n_steps = 2000;
    for (unsigned int k = 0; k < n_steps; ++k)
      scene.advance();
    for (const double u : scene.state.displacement)
      EXPECT_LT(std::abs(u), allowed(n_steps, 10. * 1e-4));
  }

  // Blocks of 0.2 by 0.1 m in columns: coordinates that no binary number is,
  // and joints that touch without a force. What fell in the first step (by g
  // h^2) had rested on others only as far as round-off left no gap.
  TEST(Rest, FlushColumnsStayWhereTheyAre)
  {
    std::string large = wall;
    const auto put = [&large](const std::string &old, const std::string &text) {
      large.replace(large.find(old), old.size(), text);
    };
    put("set dimension = 2", "set dimension = 2\nset motion = large");
    put("upper corner = 10, 1", "upper corner = 1, 0.6");
    put("cells        = 10, 10", "cells        = 5, 6");
    put("  set where    = bottom\n", "");
    put("step  = 10 ms", "step  = 1 ms");
    Scene<2> scene(large);
    constexpr unsigned int n_steps = 200;
    for (unsigned int k = 0; k < n_steps; ++k)
      scene.advance();
    // one fall of the first step, at the tolerance of the solver
    for (const double u : scene.state.displacement)
      EXPECT_LT(std::abs(u), 10. * 1e-6 * 1e-8);
    EXPECT_EQ(scene.state.energy.kinetic, 0.);
  }

  /** Three bricks on each other on a floor, 12 contacts in space, that gravity
      pulls aside by less than friction holds. */
  std::string stack()
  {
    std::string text = R"(
set dimension = 3
set motion    = large
subsection Mesh
  set type = bodies
end
subsection Material: m
  set model   = rigid
  set density = 1000
end
subsection Interface: none
  set law = rigid
end
subsection Contact: all
  set friction = 0.5
end
subsection Obstacle: floor
  set where    = z < 1 um
  set point    = 0, 0, 0
  set normal   = 0, 0, 1
  set friction = 0.5
end
subsection Loads
  set gravity = 1, 0, -10
end
subsection Time
  set end  = 100
  set step = 10 ms
end
)";
    const char *const corners[3][2] = {{"0, 0, 0", "1, 1, 0.5"},
                                       {"0.2, 0.1, 0.5", "1.2, 1.1, 1"},
                                       {"0.1, 0.2, 1", "1.1, 1.2, 1.5"}};
    for (unsigned int b = 0; b < 3; ++b)
      text += "subsection Body: brick" + std::to_string(b) +
              "\n  set type = brick\n  set cells = 1, 1, 1\n"
              "  set lower corner = " +
              corners[b][0] + "\n  set upper corner = " + corners[b][1] +
              "\nend\n";
    return text;
  }

  // it had taken 10 370 steps for 3000, 7370 of them shorter ones
  TEST(Rest, BricksDoNotCreep)
  {
    Scene<3> scene(stack());
    const State start = scene.state;
    constexpr unsigned int n_steps = 3000;
    for (unsigned int k = 0; k < n_steps; ++k)
      scene.advance();
    for (std::size_t i = 0; i < scene.state.displacement.size(); ++i)
      EXPECT_LT(std::abs(scene.state.displacement[i] - start.displacement[i]),
                allowed(n_steps, std::sqrt(101.) * 1e-4));
  }
} // namespace test_rest
