#include "compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

// A scene and its copy in the mirror, x -> L - x, behave alike: nothing in the
// program prefers a side.

namespace end_to_end::test_mirror
{
  namespace
  {
    using Strings = std::vector<std::string>;
    using Pair = std::pair<std::string, std::string>;

    struct MirrorRow {
      std::string name;
      Strings both, original, mirrored;  ///< for --set
      Pair edit_original, edit_mirrored; ///< old and new text of the file
      std::vector<Pair> reactions;       ///< driven side, its mirror image
      bool to_first_failure;
      double tolerance;
    };

    const std::vector<MirrorRow> rows = {
        {"bar_wall",
         {"Mesh/cells=40, 1"},
         {},
         {"Obstacle: wall/where=right", "Obstacle: wall/point=15 m, 0 m",
          "Obstacle: wall/normal=-1, 0",
          "Material: bar/initial velocity x=10 m/s"},
         {},
         {},
         {},
         false,
         1e-8},
        // the same one of three planes
        {"spall_square",
         {"Mesh/cells=200, 1", "Interface: plane/toughness=10"},
         {"Interface: plane/where=min(abs(x - 0.85 m), abs(x - 0.9 m), "
          "abs(x - 0.95 m)) < 1 mm"},
         {"Interface: plane/where=min(abs(x - 0.15 m), abs(x - 0.1 m), "
          "abs(x - 0.05 m)) < 1 mm"},
         {},
         {"Boundary: left\n  set traction x = if(t < l/c, sigma, 0)",
          "Boundary: right\n  set traction x = if(t < l/c, -sigma, 0)"},
         {},
         false,
         1e-8},
        // the scene is its own mirror image: hold one side instead
        {"patch_blocks",
         {},
         {},
         {},
         {"set traction x = -1e-3", "set velocity x = 0"},
         {"set traction x = 1e-3", "set velocity x = 0"},
         {{"left", "right"}},
         false,
         1e-8},
        // plane and speeds off the middle, for the same reason
        {"midplane",
         {"Mesh/cells=10, 10", "Time/step=0.3 courant"},
         {"Interface: midline/where=abs(x - 4 um) < 1 nm",
          "Boundary: left/velocity x=-1 m/s",
          "Boundary: right/velocity x=3 m/s"},
         {"Interface: midline/where=abs(x - 6 um) < 1 nm",
          "Boundary: left/velocity x=-3 m/s",
          "Boundary: right/velocity x=1 m/s"},
         {},
         {},
         {{"left", "right"}, {"right", "left"}},
         true,
         1e-8},
    };

    Result show(const Workspace &workspace, const MirrorRow &row,
                const std::string &name, const Strings &more, const Pair &edit)
    {
      std::string text = read_text(scene(row.name));
      if (const std::size_t at = text.find(edit.first);
          !edit.first.empty() && at != std::string::npos)
        text.replace(at, edit.first.size(), edit.second);
      else
        EXPECT_TRUE(edit.first.empty()) << "no `" << edit.first << "`";
      const auto file = workspace.path() / (name + ".prm");
      write_text(file, text);
      Strings set = {"Solver/tolerance=1e-11", "Output/fields=false"};
      set.insert(set.end(), row.both.begin(), row.both.end());
      set.insert(set.end(), more.begin(), more.end());
      return good_run(workspace, name, {file, set});
    }

    void PrintTo(const MirrorRow &row, std::ostream *stream)
    {
      *stream << row.name;
    }

    class MirrorTest : public testing::TestWithParam<MirrorRow>
    {
    };
  } // namespace

  TEST_P(MirrorTest, ShowsTheSame)
  {
    const MirrorRow &row = GetParam();
    const Workspace workspace;
    const Result a = show(workspace, row, "original", row.original,
                          row.edit_original),
                 b = show(workspace, row, "mirrored", row.mirrored,
                          row.edit_mirrored);
    ASSERT_TRUE(a.completed() && b.completed());

    std::size_t n = a.history.size();
    if (row.to_first_failure) {
      n = rows_without_damage(a.history);
      EXPECT_EQ(n, rows_without_damage(b.history));
      EXPECT_GT(n, 10u);
      EXPECT_LT(n, a.history.size());
      expect_below(
          "dissipation at the end",
          std::abs(a.dissipated("damage") / b.dissipated("damage") - 1.),
          row.tolerance, "the whole plane in either copy");
    } else
      for (const auto &[key, value] : a.summary["errors"].items())
        expect_below(key, std::abs(b.error(key) - value.get<double>()),
                     row.tolerance);
    expect_below("energies", energy_difference(a.history, b.history, n),
                 row.tolerance, "solver tolerance 1e-11 per step");
    for (const auto &[original, image] : row.reactions)
      expect_below("reaction " + original,
                   column_difference(a.history, "reaction_" + original + "_x",
                                     b.history, "reaction_" + image + "_x", -1.,
                                     n),
                   row.tolerance);
  }

  INSTANTIATE_TEST_SUITE_P(Table, MirrorTest, testing::ValuesIn(rows),
                           [](const auto &info) { return info.param.name; });
} // namespace end_to_end::test_mirror
