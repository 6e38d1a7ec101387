#include "../unit/held_scenes.h"
#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// Scenes as users write them, with the settings that a scene has by itself:
// they go through, and the certificate finds nothing.

namespace end_to_end::test_user_scenes
{
  namespace
  {
    void expect_ok(const std::string &text, const std::vector<std::string> &set)
    {
      const Workspace workspace;
      const auto file = workspace.path() / "scene.prm";
      write_text(file, text);
      const Result result = run(workspace, "scene", {file, set});
      ASSERT_TRUE(result.completed()) << result.description();
      EXPECT_TRUE(result.summary.at("certificate").at("ok").get<bool>())
          << result.outcome.out;
      EXPECT_EQ(result.counter("rejected_steps"), 0.);
    }
  } // namespace

  TEST(UserScenes, DrivenJoints) { expect_ok(::nsfd::test::driven, {}); }

  TEST(UserScenes, ABlockIsDraggedOverAnother)
  {
    expect_ok(::nsfd::test::dragged, {"Time/theta=0.5", "Time/end=0.3 ms"});
  }

  TEST(UserScenes, BlocksArePressed)
  {
    expect_ok(::nsfd::test::pressed, {"Time/theta=0.5", "Time/end=2 ms"});
  }

  namespace
  {
    /** A column of weak mortar under gravity and `a` of it to the side. */
    constexpr char column[] = R"(
set dimension = 2
set motion    = large
subsection Constants
  set a = 0.7
end
subsection Mesh
  set type         = rectangle
  set upper corner = 0.2 m, 0.6 m
  set cells        = 1, 3
end
subsection Material: stone
  set Young modulus = 30 GPa
  set Poisson ratio = 0.2
  set density       = 2500 kg/m^3
end
subsection Interface: mortar
  set where     = y > 0.19 && y < 0.21
  set law       = camacho-ortiz
  set strength  = 100 Pa
  set toughness = 1e-3 J/m^2
  set friction  = 1
end
subsection Interface: inside
  set law = joined
end
subsection Contact: any
  set friction = 1
end
subsection Boundary: foot
  set where      = y < 0.201
  set velocity x = 0
  set velocity y = 0
end
subsection Loads
  set gravity = a * 9.81, -9.81
end
subsection Time
  set scheme = moreau-jean
  set end    = 0.2 s
  set step   = 1 ms
end
)";

    /** J, of a rigid block of 0.2 by 0.4 m that tips over its corner. */
    double tipped(const double a, const double end)
    {
      constexpr double g = 9.81, m = 200., I = m * (0.04 + 0.16) / 3.;
      double angle = 0., speed = 0.;
      constexpr unsigned int n = 20000;
      for (unsigned int k = 0; k < n; ++k) {
        const double s = std::sin(angle), c = std::cos(angle);
        speed += end / n * m * g *
                 (a * (0.2 * c + 0.1 * s) + (-0.1 * c + 0.2 * s)) / I;
        speed = std::max(speed, 0.);
        angle += end / n * speed;
      }
      return I * speed * speed / 2.;
    }
  } // namespace

  // It stands up to a = 1/2, and rolls over its corner beyond that. The load
  // comes at once: what it leaves of elastic waves is some hundredths of the
  // energy.
  TEST(UserScenes, AColumnTipsOverItsCorner)
  {
    expect_ok(column, {});
    const Workspace workspace;
    const auto file = workspace.path() / "column.prm";
    write_text(file, column);
    const auto kinetic = [&](const std::string &a) {
      const Result result =
          good_run(workspace, "a" + a, {file, {"Constants/a=" + a}});
      return result.history["kinetic"].back();
    };
    const double expected = tipped(0.7, 0.2);
    EXPECT_NEAR(kinetic("0.7") / expected, 1., 0.05);
    EXPECT_LT(kinetic("0.48"), 1e-3 * expected);
  }

  TEST(UserScenes, AProjectileBreaksAPlate)
  {
    const Workspace workspace;
    const Result result =
        run(workspace, "projectile", {benchmark("projectile")});
    ASSERT_TRUE(result.completed()) << result.description();
    EXPECT_GT(result.number("fragments"), 2);
    const auto &lines = result.summary.at("certificate").at("lines");
    for (const char *const line :
         {"balance residual", "given by friction", "given by impact",
          "given by time scheme", "given by large motion", "penetration"})
      if (lines.contains(line)) {
        EXPECT_EQ(lines.at(line).at("verdict").get<std::string>(), "ok")
            << line;
      }
  }
} // namespace end_to_end::test_user_scenes
