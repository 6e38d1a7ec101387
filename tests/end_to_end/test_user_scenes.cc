#include "../unit/held_scenes.h"
#include "compare.h"

#include <gtest/gtest.h>

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
