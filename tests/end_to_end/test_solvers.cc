#include "compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

// Both solvers on both paths find the same velocities, jumps and energies.
// (Impulses and tractions need not agree: rigid rows around a vertex and
// several contacts of a rigid block are hyperstatic.)

namespace end_to_end::test_solvers
{
  namespace
  {
    struct SolverRow {
      std::string name;
      std::vector<std::string> set; ///< coarser, where sweeps would take long
      double energies, velocities, jumps;
      std::string reason;
      std::string tolerance = "1e-10";
    };

    // Tolerance 1e-10 of the natural map per step. What it leaves in the
    // energies is of the same order; velocities and jumps behind a front
    // collect some more over the steps.
    const std::string plain = "10 times what 1e-10 per step leaves";
    const std::vector<SolverRow> rows = {
        {"ball", {"Output/fields every=0.25 s"}, 1e-9, 1e-8, 1e-8, plain},
        {"bar_wall", {"Mesh/cells=40, 1"}, 1e-9, 1e-8, 1e-9, plain},
        {"bimodular", {"Mesh/cells=40, 1"}, 1e-8, 1e-7, 1e-8, plain},
        {"escape", {"Output/fields every=20 us"}, 1e-9, 1e-9, 1e-9, plain},
        {"incline", {"Output/fields every=0.1 s"}, 1e-9, 1e-9, 1e-9, plain},
        {"interface_step", {"Mesh/cells=80, 1"}, 1e-9, 1e-8, 1e-8, plain},
        {"mode", {}, 1e-8, 1e-8, 1e-8, "700 steps of 1e-10"},
        // The scene's own Courant numbers, 20 and 40, are for the assembled
        // path; sweeps need some 1.
        {"patch_blocks",
         {"Time/step=1", "Time/end=20"},
         1e-9,
         1e-9,
         1e-9,
         plain,
         "1e-12"},
        {"patch_crossed",
         {"Mesh/cells=2, 2", "Time/step=0.5", "Time/end=10"},
         1e-9,
         1e-9,
         1e-9,
         plain,
         "1e-12"},
        {"rigid_motion", {}, 1e-11, 1e-11, 1e-11, "round-off"},
        {"step_load", {"Output/fields every=20 us"}, 1e-9, 1e-9, 1e-9, plain},
        {"stop", {"Output/fields every=50 ms"}, 1e-9, 1e-9, 1e-9, plain},
    };

    struct Choice {
      const char *method, *path;
    };
    const Choice choices[] = {{"dual newton", "local"},
                              {"dual newton", "assembled"},
                              {"gauss seidel", "local"},
                              {"gauss seidel", "assembled"}};

    Result solve(const Workspace &workspace, const std::string &name,
                 const std::vector<std::string> &set, const Choice &choice,
                 const std::string &tolerance = "1e-10")
    {
      std::vector<std::string> all = {std::string("Solver/method=") +
                                          choice.method,
                                      std::string("Solver/path=") + choice.path,
                                      "Solver/tolerance=" + tolerance};
      all.insert(all.end(), set.begin(), set.end());
      return good_run(workspace,
                      name + ", " + choice.method + ", " + choice.path,
                      {name == "torn_plate" ? torn_plate() : scene(name), all});
    }

    void PrintTo(const SolverRow &row, std::ostream *stream)
    {
      *stream << row.name;
    }

    class SolversTest : public testing::TestWithParam<SolverRow>
    {
    };
  } // namespace

  TEST_P(SolversTest, Agree)
  {
    const SolverRow &row = GetParam();
    const Workspace workspace;
    const Result reference =
        solve(workspace, row.name, row.set, choices[0], row.tolerance);
    ASSERT_TRUE(reference.completed());
    for (unsigned int i = 1; i < 4; ++i) {
      const Result other =
          solve(workspace, row.name, row.set, choices[i], row.tolerance);
      ASSERT_TRUE(other.completed());
      const std::string name = other.directory.filename().string();
      expect_below(name + ": energies",
                   energy_difference(reference.history, other.history),
                   row.energies, row.reason);
      expect_below(name + ": velocities",
                   field_difference(reference, other, "fields", "velocity",
                                    "fields", "velocity"),
                   row.velocities, row.reason);
      expect_below(name + ": jumps",
                   field_difference(reference, other, "interfaces", "jump",
                                    "fields", "displacement"),
                   row.jumps, row.reason);
    }
  }

  INSTANTIATE_TEST_SUITE_P(Table, SolversTest, testing::ValuesIn(rows),
                           [](const auto &info) { return info.param.name; });

  // The steps of a quasi-static run: conjugate gradients on the faces against
  // the factored assembled matrix.
  TEST(Solvers, PathsAgreeAtLongSteps)
  {
    for (const std::string name : {"patch_blocks", "patch_crossed"}) {
      const Workspace workspace;
      const Result faces = solve(workspace, name, {}, choices[0], "1e-12"),
                   assembled = solve(workspace, name, {}, choices[1], "1e-12");
      ASSERT_TRUE(faces.completed() && assembled.completed());
      expect_below(name + ": energies",
                   energy_difference(faces.history, assembled.history), 1e-7,
                   "W + D has the square of the Courant number, 20 to 40, "
                   "for its condition number: 1e-12 grows to 1e-9 and more");
    }
  }

  // Rigid rows, activation, softening, separation: alike up to the first
  // activation, and the same dissipation after it.
  TEST(Solvers, AgreeOnMidplane)
  {
    const Workspace workspace;
    const std::vector<std::string> set = {"Mesh/cells=10, 10",
                                          "Time/step=0.3 courant",
                                          "Output/fields every=1 ns"};
    const Result reference = solve(workspace, "midplane", set, choices[0]);
    ASSERT_TRUE(reference.completed());
    const std::size_t n = rows_without_damage(reference.history);
    EXPECT_GT(n, 10u);
    EXPECT_LT(n, reference.history.size());
    for (unsigned int i = 1; i < 4; ++i) {
      const Result other = solve(workspace, "midplane", set, choices[i]);
      ASSERT_TRUE(other.completed());
      const std::string name = other.directory.filename().string();
      expect_below(name + ": energies, intact",
                   energy_difference(reference.history, other.history, n),
                   1e-9);
      expect_below(name + ": all energies",
                   energy_difference(reference.history, other.history), 1e-8);
      expect_below(
          name + ": dissipation",
          std::abs(other.dissipated("damage") / reference.dissipated("damage") -
                   1.),
          1e-4);
      expect_below(name + ": velocities",
                   field_difference(reference, other, "fields", "velocity",
                                    "fields", "velocity"),
                   1e-7);
    }
  }

  // The three procedures for damage and friction: a fixed point around the
  // contact solve (plain and accelerated), Newton, Gauss-Seidel.
  TEST(Solvers, ProceduresAgree)
  {
    struct Scene {
      std::string name;
      std::vector<std::string> set;
      double bound;
    };
    const Scene scenes[] = {
        {"midplane", {"Mesh/cells=10, 10", "Time/step=0.1 courant"}, 1e-6},
        {"torn_plate", {"Time/end=70 us"}, 1e-6},
        {"stop", {}, 1e-8},
        {"step_load", {}, 1e-7}};
    for (const Scene &row : scenes) {
      const Workspace workspace;
      const Result reference = solve(workspace, row.name, row.set, choices[0]);
      ASSERT_TRUE(reference.completed());
      for (const char *const method : {"fixed point", "anderson"}) {
        const Result other =
            solve(workspace, row.name, row.set, {method, "local"});
        ASSERT_TRUE(other.completed());
        expect_below(row.name + ", " + method + ": damage",
                     std::abs(other.dissipated("damage") -
                              reference.dissipated("damage")) /
                         std::max(reference.dissipated("damage"), 1e-300),
                     row.bound);
        expect_below(row.name + ", " + method + ": friction",
                     std::abs(other.dissipated("friction") -
                              reference.dissipated("friction")) /
                         std::max(reference.dissipated("friction"), 1e-300),
                     row.bound);
      }
    }
  }

  // The plane exactly at the block, where the gap of a resting contact is the
  // round-off of the solver: the contact must be kept in every step.
  TEST(Solvers, RestingContactIsKept)
  {
    for (const std::string name : {"incline", "stop"})
      for (unsigned int i = 0; i < 3; ++i)
        for (const std::string tolerance : {"1e-8", "1e-10"}) {
          const Workspace workspace;
          const Result result =
              solve(workspace, name, {"Obstacle: plane/point=0, 0"}, choices[i],
                    tolerance);
          ASSERT_TRUE(result.completed());
          for (const char *const error :
               name == "incline"
                   ? std::array{"position", "velocity", "normal_reaction"}
                   : std::array{"distance", "friction_work", "stop_time"})
            expect_below(result.directory.filename().string() + ", " +
                             tolerance + ": " + error,
                         result.error(error), 1e-5,
                         "a lost contact costs a step of 0.01 or more");
        }
  }

  // Rows joined rigidly all around leave W singular: impulses may grow along
  // its null space, but never so far that the step is wrong.
  TEST(Solvers, GlobalPathClosesTheBalanceNextToRigidRows)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "midplane",
                 {scene("midplane"),
                  {"Mesh/cells=20, 20", "Solver/path=assembled",
                   "Solver/tolerance=1e-11", "Output/fields=false"}});
    ASSERT_TRUE(result.completed());
    expect_below("damage", result.error("damage"), 1e-4);
  }
} // namespace end_to_end::test_solvers
