#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// What supports and joints give: steps may be so long that impulses are a
// million times as large as what moves, and the velocity that a tolerance of
// impulses leaves at a support would work with all of that.

namespace end_to_end::test_supports
{
  namespace
  {
    /** Held at the left, joined in the middle, driven at the right. */
    const char *const bar = R"(
set dimension = 2
subsection Constants
  set h = 0.1 ms
end
subsection Mesh
  set type         = rectangle
  set upper corner = 100 mm, 10 mm
  set cells        = 40, 4
end
subsection Material: steel
  set Young modulus = 200 GPa
  set Poisson ratio = 0.3
  set density       = 7800 kg/m^3
end
subsection Interface: middle
  set where = abs(x - 50 mm) < 1 um
  set law   = rigid
end
subsection Interface: rest
  set law = joined
end
subsection Boundary: left
  set displacement x = 0
  set displacement y = 0
end
subsection Boundary: right
  set displacement x = 0.01 mm * sin(2 * pi * t / (90 * h))
  set displacement y = 0.05 mm * (1 - cos(2 * pi * t / (90 * h)))
end
subsection Time
  set scheme = moreau-jean
  set step   = h
  set end    = 100 * h
end
)";

    double line(const Result &result, const std::string &name,
                const std::string &what)
    {
      return result.summary.at("certificate")
          .at("lines")
          .at(name)
          .at(what)
          .get<double>();
    }

    double largest(const Result &result, const std::string &column)
    {
      double value = 0.;
      for (const double x : result.history[column])
        value = std::max(value, std::abs(x));
      return value;
    }
  } // namespace

  // The sound crosses the bar in 20 us: 5 and 100 times in a step. With a
  // tolerance of 1e-8 alone supports and joints give some per cent of all
  // energies, or many times as much.
  TEST(LongSteps, SupportsAndJointsGiveNothing)
  {
    for (const char *const step : {"1 us", "0.1 ms", "2 ms"})
      for (const char *const tolerance : {"1e-6", "1e-8"}) {
        SCOPED_TRACE(std::string(step) + ", tolerance " + tolerance);
        const Workspace workspace;
        const auto file = workspace.path() / "bar.prm";
        write_text(file, bar);
        const Result result =
            good_run(workspace, "run",
                     {file,
                      {std::string("Constants/h=") + step,
                       std::string("Solver/tolerance=") + tolerance},
                      1,
                      true});
        ASSERT_TRUE(result.completed());
        EXPECT_EQ(result.counter("rejected_steps"), 0.);
        for (const char *const name :
             {"given by supports", "given by joints"}) {
          EXPECT_EQ(line(result, name, "bound"), 1e-9) << name;
          EXPECT_LE(line(result, name, "value"), 1e-9) << name;
        }
        const double energy =
            std::max(largest(result, "elastic"), largest(result, "kinetic"));
        ASSERT_GT(energy, 0.);
        expect_below("numerical, by the joint",
                     largest(result, "numerical") / energy, 1e-9);
      }
  }

  // Of U_free + W P the last bits are all there is: they are part of the bound.
  TEST(LongSteps, SupportsOfRigidBlocksOnSpringsGiveNothing)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "run", {scene("dcb_beam"), {}, 1, true});
    expect_below("given", line(result, "given by supports", "value"), 1e-9);
    expect_below("bound", line(result, "given by supports", "bound"), 2e-9);
  }
} // namespace end_to_end::test_supports
