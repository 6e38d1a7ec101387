#include "compare.h"

#include <gtest/gtest.h>

#include <cmath>

// What is exact in one dimension is so in a plane strip and in a column.

namespace end_to_end::test_dimensions
{
  namespace
  {
    using Strings = std::vector<std::string>;

    void expect_column_like_strip(const std::string &name, const Strings &strip,
                                  const Strings &column)
    {
      const Workspace workspace;
      const auto solve = [&](const char *as, Strings set) {
        set.push_back("Solver/tolerance=1e-11");
        set.push_back("Output/fields=false");
        return good_run(workspace, as, {scene(name), set});
      };
      const Result plane = solve("strip", strip),
                   solid = solve("column", column);
      ASSERT_TRUE(plane.completed() && solid.completed());
      EXPECT_EQ(solid.number("dimension"), 3);
      expect_below("energies", energy_difference(plane.history, solid.history),
                   1e-10);
      for (const auto &[key, value] : plane.summary["errors"].items())
        expect_below(key, std::abs(solid.error(key) - value.get<double>()),
                     1e-10);
    }
  } // namespace

  TEST(Dimensions, BarHitsTheWall)
  {
    expect_column_like_strip(
        "bar_wall", {"Mesh/cells=30, 1"},
        {"dimension=3", "Mesh/type=brick", "Mesh/cells=30, 1, 1",
         "Mesh/lower corner=0, 0, 0", "Mesh/upper corner=10 m, 0.1 m, 0.1 m",
         "Obstacle: wall/point=-5 m, 0, 0", "Obstacle: wall/normal=1, 0, 0"});
  }

  TEST(Dimensions, WaveMeetsAnInterface)
  {
    expect_column_like_strip(
        "interface_step", {"Mesh/cells=60, 1"},
        {"dimension=3", "Mesh/type=brick", "Mesh/cells=60, 1, 1",
         "Mesh/lower corner=0, 0, 0", "Mesh/upper corner=1 m, 5 mm, 5 mm"});
  }

  // The patch test in space: six tetrahedra per cube, 2 x 2 x 2 cubes.
  TEST(Dimensions, PatchOfTetrahedra)
  {
    const Workspace workspace;
    std::string text = read_text(scene("patch_crossed"));
    const std::size_t plane = text.find("set plane");
    ASSERT_NE(plane, std::string::npos);
    text.erase(plane, text.find('\n', plane) - plane);
    const auto file = workspace.path() / "patch.prm";
    write_text(file, text);
    const Result result =
        good_run(workspace, "tetrahedra",
                 {file,
                  {"dimension=3", "Mesh/type=tetrahedra", "Mesh/cells=2, 2, 2",
                   "Mesh/lower corner=0, 0, 0", "Mesh/upper corner=2, 2, 2"}});
    ASSERT_TRUE(result.completed());
    expect_below("compliance", std::abs(result.error("compliance") - 1.5949747),
                 1e-7, "1 + (1/2)/5 + sqrt(1/2)(1/5 + 1/2)");
    expect_below("modulus", result.error("modulus"), 5e-8,
                 "solver tolerance 1e-12 at Courant number 40");
    expect_below("stress", result.error("stress"), 5e-8);
  }
} // namespace end_to_end::test_dimensions
