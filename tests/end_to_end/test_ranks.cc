#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>

// One, two and four ranks give the same files: bit for bit on the local
// path, to 1e-9 with assembled matrices. What is wrong is said once.

namespace end_to_end::test_ranks
{
  namespace
  {
    struct RankRow {
      std::string name;
      std::vector<std::string> local, assembled;
      std::string scene = name; ///< the file
    };

    const std::vector<std::string> column = {"dimension=3",
                                             "Mesh/type=brick",
                                             "Mesh/cells=8, 2, 2",
                                             "Mesh/lower corner=0, 0, 0",
                                             "Mesh/upper corner=10 m, 1 m, 1 m",
                                             "Mesh/distortion=0.2",
                                             "Solver/tolerance=1e-12",
                                             "Obstacle: wall/point=-5 m, 0, 0",
                                             "Obstacle: wall/normal=1, 0, 0"};

    // small and short: what is compared is the arithmetic, not the physics
    const std::vector<RankRow> rows = {
        {"ball", {"Time/end=0.6 s"}, {"Time/end=0.6 s"}},
        {"bar_wall", {"Mesh/cells=30, 1"}, {"Mesh/cells=20, 1"}},
        {"bimodular",
         {"Mesh/cells=30, 1"},
         {"Mesh/cells=20, 1", "Time/end=200 us"}},
        {"crack_pressure", {"Mesh/cells=40, 1"}, {"Mesh/cells=40, 1"}},
        {"drag_block",
         {"Time/end=0.95 s", "Time/step=5 ms"},
         {"Time/end=0.95 s", "Time/step=5 ms"}},
        {"damped_wave", {"Constants/n=8"}, {"Constants/n=8", "Time/end=60 us"}},
        {"escape", {}, {}},
        {"graded_bar", {}, {}},
        {"incline", {}, {}},
        {"interface_law",
         {"Mesh/cells=60, 1", "Time/end=220 us"},
         {"Mesh/cells=40, 1", "Time/end=220 us", "Solver/tolerance=1e-12"}},
        {"interface_step", {"Mesh/cells=60, 1"}, {"Mesh/cells=40, 1"}},
        {"midplane",
         {"Mesh/cells=10, 10"},
         {"Mesh/cells=10, 10", "Time/end=4 ns", "Solver/tolerance=1e-12"}},
        {"midplane_scattered",
         {"Mesh/cells=10, 10", "Interface: midline/scatter=weibull",
          "Interface: midline/strength modulus=8",
          "Interface: midline/toughness modulus=5",
          "Interface: midline/opening viscosity=5 MPa*s/m",
          "Interface: midline/toughness factor=1 + 0.3 * sin(y / 1 um)"},
         {"Mesh/cells=10, 10", "Interface: midline/scatter=weibull",
          "Interface: midline/strength modulus=8", "Time/end=4 ns",
          "Solver/tolerance=1e-12"},
         "midplane"},
        {"mode", {"Time/end=200 us"}, {"Time/end=100 us"}},
        {"patch_blocks", {}, {}},
        // Courant number 20: jumps are known to C h^2 = 2000 tolerances
        {"patch_crossed", {}, {"Solver/tolerance=1e-13"}},
        {"rigid_motion", {}, {}},
        {"static_crossed", {}, {}},
        {"static_michel", {"Mesh/cells=4, 2"}, {"Mesh/cells=4, 2"}},
        {"step_load", {}, {}},
        {"tube", {}, {}},
        {"stop", {}, {}},
        {"bar_wall_in_space", column, column, "bar_wall"},
        {"midplane_pressure",
         {"Mesh/cells=10, 10",
          "Interface: midline/crack pressure=10 MPa * (1 + y / 10 um)"},
         {"Mesh/cells=10, 10", "Time/end=4 ns", "Solver/tolerance=1e-12",
          "Interface: midline/broken=y < 5 um",
          "Interface: midline/crack pressure=10 MPa * (1 + y / 10 um)"},
         "midplane"},
        // damage, contact and friction together, and sweeps where Newton stalls
        {"torn_plate",
         {"Mesh/cells=12, 9", "Time/step=0.4 us", "Constants/turn=60 us",
          "Constants/pull=4 m/s", "Time/end=120 us"},
         {"Mesh/cells=12, 9", "Time/step=0.4 us", "Constants/pull=4 m/s",
          "Time/end=42 us", "Solver/tolerance=1e-12"}},
    };

    std::filesystem::path file_of(const RankRow &row)
    {
      return row.scene == "torn_plate" ? torn_plate() : scene(row.scene);
    }

    void PrintTo(const RankRow &row, std::ostream *stream)
    {
      *stream << row.name;
    }

    class RanksTest : public testing::TestWithParam<RankRow>
    {
    };
  } // namespace

  TEST_P(RanksTest, AreTheSameBitForBitElementWise)
  {
    const RankRow &row = GetParam();
    const Workspace workspace;
    std::vector<std::string> set = {"Solver/path=local"};
    set.insert(set.end(), row.local.begin(), row.local.end());
    const Result one = good_run(workspace, "1 rank", {file_of(row), set});
    ASSERT_TRUE(one.completed());
    const auto fields = records(one, "fields");
    for (const unsigned int n : {2u, 4u}) {
      const Result several = good_run(workspace, std::to_string(n) + " ranks",
                                      {file_of(row), set, n});
      ASSERT_TRUE(several.completed());
      EXPECT_TRUE(one.history_text == several.history_text)
          << "history.csv of " << n << " ranks differs by "
          << energy_difference(one.history, several.history);
      EXPECT_EQ(one.summary["errors"], several.summary["errors"]);
      EXPECT_EQ(one.summary["penetration_max"],
                several.summary["penetration_max"]);
      EXPECT_EQ(one.summary["fragments"], several.summary["fragments"]);
      EXPECT_TRUE(fields == records(several, "fields"))
          << "fields of " << n << " ranks";
    }
  }

  TEST_P(RanksTest, AgreeWithGlobalSolves)
  {
    const RankRow &row = GetParam();
    const Workspace workspace;
    std::vector<std::string> set = {"Solver/path=assembled",
                                    "Output/fields=false"};
    set.insert(set.end(), row.assembled.begin(), row.assembled.end());
    const Result one = good_run(workspace, "1 rank", {file_of(row), set});
    ASSERT_TRUE(one.completed());
    for (const unsigned int n : {2u, 4u}) {
      const Result several = good_run(workspace, std::to_string(n) + " ranks",
                                      {file_of(row), set, n});
      ASSERT_TRUE(several.completed());
      expect_below(std::to_string(n) + " ranks: energies",
                   energy_difference(one.history, several.history), 1e-9,
                   "up to the first solution jump");
    }
  }

  // Rubbing cracks at Courant number 2 by interior points, whose factor is on
  // the first rank: the energies of one rank to 1e-9 of the largest.
  TEST(Ranks, InteriorPointsAgree)
  {
    const Workspace workspace;
    const std::vector<std::string> set = {
        "Constants/n=6",         "Mesh/cells=6, 6",
        "Constants/share=0.4",   "Time/step=2 courant",
        "Time/end=1.4",          "Solver/method=interior point",
        "Solver/tolerance=1e-12"};
    const auto file = benchmark("broken_faces");
    const Result one = good_run(workspace, "1 rank", {file, set});
    ASSERT_TRUE(one.completed());
    const Result two = good_run(workspace, "2 ranks", {file, set, 2});
    ASSERT_TRUE(two.completed());
    EXPECT_EQ(one.summary["steps"], two.summary["steps"]);
    expect_below("2 ranks: energies",
                 energy_difference(one.history, two.history), 1e-9);
  }

  // Bonded faces are released on one rank while nothing changes on the other:
  // both must make the new factor. A rank that waits for ever is ended.
  TEST(Ranks, BondsThatBreakOnOneRankAgree)
  {
    const Workspace workspace;
    const Result one = good_run(workspace, "1 rank", {scene("crack_path"), {}});
    const Result two =
        good_run(workspace, "2 ranks", {scene("crack_path"), {}, 2});
    ASSERT_TRUE(one.completed() && two.completed());
    for (const char *name : {"crack_length", "crack_extent", "crack_start"})
      EXPECT_NEAR(two.error(name) / one.error(name), 1., 1e-12) << name;
  }

  // Explicit steps of common nodes: their mass is shared by the ranks. What the
  // tolerance leaves grows with damage, by 1e5 and more, until faces that are
  // about to open do so in another order.
  TEST(Ranks, ExplicitBondsAgree)
  {
    const Workspace workspace;
    // All breaking is over at 8.3 ns. At 8.72 ns a step is solved or halved by
    // the last digits, which are others with other kernels of BLAS.
    const std::vector<std::string> set = {
        "Mesh/cells=8, 8",        "Time/end=8.6 ns",
        "Output/fields=false",    "Time/scheme=symplectic",
        "Time/step=0.05 courant", "Solver/tolerance=1e-12"};
    const auto file = benchmark("fracture_extrinsic");
    const Result one = good_run(workspace, "1 rank", {file, set});
    EXPECT_GT(one.counter("released_bonds"), 0.);
    for (const unsigned int ranks : {2u, 3u}) {
      const Result other = good_run(workspace, std::to_string(ranks) + " ranks",
                                    {file, set, ranks});
      expect_below(std::to_string(ranks) + " ranks: energies",
                   energy_difference(one.history, other.history), 1e-9);
      EXPECT_EQ(other.counter("released_bonds"), one.counter("released_bonds"));
    }
  }

  namespace
  {
    // obstacles, balls, pins, springs that break and crack faces that meet
    // again, several bodies, edges in space, history-dependent materials;
    // short, since ranks that share a core wait for each other in every sum
    const std::vector<RankRow> moving_rows = {
        {"rocking", {"Time/end=0.05 s"}, {}},
        {"cradle", {"Time/end=20 ms"}, {}},
        {"roll", {}, {}},
        {"heavy_top", {"Time/end=2 ms"}, {}},
        {"plastic_bar", {"Time/end=10 us"}, {}},
        {"falling_wall", {"Time/end=10 ms"}, {}},
        {"push_back", {"Mesh/cells=6, 6", "Time/end=17 ns"}, {}},
        {"impactor", {"Time/end=10 us"}, {}},
        {"heap_of_bricks", {"Time/end=0.1 s"}, {}},
    };

    class MovingRanksTest : public testing::TestWithParam<RankRow>
    {
    };
  } // namespace

  TEST_P(MovingRanksTest, AreTheSameBitForBit)
  {
    const RankRow &row = GetParam();
    const auto file = std::filesystem::exists(scene(row.name))
                          ? scene(row.name)
                          : benchmark(row.name);
    const Workspace workspace;
    const Result one = good_run(workspace, "1 rank", {file, row.local});
    ASSERT_TRUE(one.completed());
    for (const unsigned int n : {2u, 3u}) {
      const Result several = good_run(workspace, std::to_string(n) + " ranks",
                                      {file, row.local, n});
      ASSERT_TRUE(several.completed());
      EXPECT_TRUE(one.history_text == several.history_text)
          << "history.csv of " << n << " ranks differs by "
          << energy_difference(one.history, several.history);
      for (const char *key :
           {"errors", "penetration_max", "fragments", "steps"})
        EXPECT_EQ(one.summary[key], several.summary[key]) << key;
      EXPECT_TRUE(records(one, "fields") == records(several, "fields"))
          << "fields of " << n << " ranks";
    }
  }

  INSTANTIATE_TEST_SUITE_P(Table, MovingRanksTest,
                           testing::ValuesIn(moving_rows),
                           [](const auto &info) { return info.param.name; });

  INSTANTIATE_TEST_SUITE_P(Table, RanksTest, testing::ValuesIn(rows),
                           [](const auto &info) { return info.param.name; });

  namespace
  {
    struct BadInput {
      std::string name;
      std::vector<std::string> arguments;
      std::string message;
    };

    const std::string stop_scene = scene("stop").string();

    // found in the file, in the mesh, on its faces, by the exact solution, and
    // on the disk
    const std::vector<BadInput> bad_inputs = {
        {"missing_file", {"missing.prm"}, "`missing.prm` cannot be read"},
        {"entry", {stop_scene, "--set", "Time/theta=0.3"}, "theta = 0.3 must"},
        {"generator",
         {"disc.prm"},
         "the generator `hyper_ball` does not accept `0`"},
        {"face_without_law",
         {scene("rigid_motion").string(), "--set",
          "Interface: springs/where=x < 0"},
         "no Interface block holds for the face"},
        // the others must not wait for the rank that finds it
        {"face_without_law_on_one_rank",
         {scene("interface_step").string(), "--set",
          "Interface: joints/where=x > 7 mm"},
         "no Interface block holds for the face at (0.005000, 0.002500)"},
        {"boundary",
         {stop_scene, "--set", "Boundary: far/where=x > 1 km", "--set",
          "Boundary: far/velocity x=0"},
         "Boundary: far: no boundary face of the mesh is there"},
        {"verification",
         {scene("incline").string(), "--set",
          "Material: block/initial velocity x=1 m/s"},
         "the block must start from rest"},
        {"output", {stop_scene, "--output", "."}, "exists already"},
    };

    void PrintTo(const BadInput &row, std::ostream *stream)
    {
      *stream << row.name;
    }

    unsigned int count(const std::string &text, const std::string &part)
    {
      unsigned int n = 0;
      for (std::size_t at = text.find(part); at != std::string::npos;
           at = text.find(part, at + part.size()))
        ++n;
      return n;
    }

    class BadInputRanksTest : public testing::TestWithParam<BadInput>
    {
    };
  } // namespace

  // No rank ends the others: each says how it ended.
  TEST_P(BadInputRanksTest, IsReportedOnceAndEndsAllRanks)
  {
    const BadInput &row = GetParam();
    const Workspace workspace;
    write_text(workspace.path() / "disc.prm",
               "# disc - a generator with too few arguments.\n"
               "subsection Mesh\n"
               "  set type      = hyper_ball\n"
               "  set arguments = 0\n"
               "end\n"
               "subsection Material: disc\n"
               "  set Young modulus = 1 GPa\n"
               "  set Poisson ratio = 0\n"
               "  set density       = 1000 kg/m^3\n"
               "end\n"
               "subsection Interface: all\n"
               "  set law = rigid\n"
               "end\n"
               "subsection Time\n"
               "  set end = 1 ms\n"
               "end\n");
    std::vector<std::string> command = {NSFD_MPIRUN,
                                        "--allow-run-as-root",
                                        "--oversubscribe",
                                        "-n",
                                        "2",
                                        "sh",
                                        "-c",
                                        "\"$0\" \"$@\"; echo ended with $?",
                                        NSFD_PROGRAM};
    command.insert(command.end(), row.arguments.begin(), row.arguments.end());
    const Outcome outcome = Process(command, workspace.path()).wait(60.);
    EXPECT_EQ(outcome.exit_code, 0) << "of mpirun and the shell\n"
                                    << outcome.err;
    EXPECT_EQ(outcome.out, "ended with 1\nended with 1\n");
    EXPECT_EQ(count(outcome.err, row.message), 1u) << outcome.err;
    EXPECT_EQ(outcome.err.find("MPI_ABORT"), std::string::npos) << outcome.err;
  }

  INSTANTIATE_TEST_SUITE_P(Table, BadInputRanksTest,
                           testing::ValuesIn(bad_inputs),
                           [](const auto &info) { return info.param.name; });
} // namespace end_to_end::test_ranks
