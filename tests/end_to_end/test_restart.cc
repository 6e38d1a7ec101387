#include "compare.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <tuple>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <ostream>
#include <random>
#include <thread>

// Runs that end in the middle of things and go on: their histories are those
// of runs that were never interrupted, to the last bit.

namespace end_to_end::test_restart
{
  namespace fs = std::filesystem;

  namespace
  {
    struct RestartRow {
      std::string name;
      Launch launch;
      double share = 0.5; ///< of the steps between two checkpoints
    };

    void PrintTo(const RestartRow &row, std::ostream *stream)
    {
      *stream << row.name;
    }

    const Launch breaking = {torn_plate(),
                             {"Mesh/cells=12, 9", "Time/step=0.4 us",
                              "Constants/turn=60 us", "Constants/pull=4 m/s",
                              "Time/end=120 us"}};

    const std::vector<std::string> plastic = {
        "Material: PMMA/model=j2 plastic", "Material: PMMA/yield stress=30 MPa",
        "Material: PMMA/isotropic hardening modulus=100 MPa",
        "Material: PMMA/kinematic hardening modulus=50 MPa"};

    const Launch midplane = {scene("midplane"), {"Mesh/cells=10, 10"}};
    const Launch bonded = with(midplane, {"Interface: elsewhere/law=bonded",
                                          "Interface: midline/intact faces="
                                          "bonded"});
    const Launch rubbing = {benchmark("broken_faces"),
                            {"Constants/n=6", "Mesh/cells=6, 6",
                             "Constants/share=0.4", "Time/step=2 courant",
                             "Time/end=1.4"}};
    const Launch torn = {benchmark("fracture_extrinsic"),
                         {"Mesh/cells=8, 8", "Time/end=9 ns"}};
    const std::string assembled = "Solver/path=assembled",
                      cg = "Solver/linear solver=cg";

    const Launch refined =
        with(torn, {"Adaptivity/levels=2", "Indicator: near/type=region",
                    "Indicator: near/region=abs(x - 4 um) < 1.5 um && y < 7 um",
                    "Indicator: near/cell size=0.5 um"});

    // halves of faces that soften and of broken ones, before and after
    const Launch bisected =
        with(torn, {"Mesh/type=crossed triangles", "Mesh/cells=6, 6",
                    "Interface: all/strength scatter=0.1", "Time/end=16 ns",
                    "Adaptivity/levels=2", "Adaptivity/ahead=0.3",
                    "Indicator: front/type=process zone",
                    "Indicator: front/cells=2", "Indicator: front/reach=0.5"});

    // whatever a step may leave to the next one
    const std::vector<RestartRow> rows = {
        {"breaking", breaking},
        {"breaking_late", breaking, 0.8},
        {"breaking_assembled", with(breaking, {assembled, "Time/end=42 us"})},
        {"breaking_cg", with(breaking, {assembled, cg, "Time/end=42 us"})},
        {"gauss_seidel",
         with(midplane,
              {"Solver/method=gauss seidel", "Interface: elsewhere/law=elastic",
               "Interface: elsewhere/normal stiffness=1e17", "Time/end=1 ns",
               "Solver/tolerance=1e-4"})},
        {"scattered",
         with(midplane, {"Interface: midline/scatter=weibull",
                         "Interface: midline/strength modulus=8",
                         "Interface: midline/opening viscosity=5 MPa*s/m"})},
        {"crack_pressure",
         with(midplane,
              {"Interface: midline/crack pressure=10 MPa * (1 + y / 10 um)"})},
        {"extrinsic", midplane},
        {"fields_in_hdf5", with(midplane, {"Output/format=hdf5"})},
        {"fields_in_vtkhdf", with(midplane, {"Output/format=vtkhdf"})},
        {"extrinsic_long_steps",
         with(midplane, {assembled, cg, "Time/step=6 courant"})},
        {"bonded", bonded},
        {"bonded_cg", with(bonded, {cg})},
        {"bonded_everywhere",
         with(torn, {"Time/scheme=moreau-jean", "Time/step=0.6 courant"})},
        // an old preconditioner is one of the resumed run too
        {"short_steps", {benchmark("spall_bar"), {"Time/end=16 us"}}},
        {"symplectic",
         with(torn, {"Time/scheme=symplectic", "Time/step=0.05 courant"})},
        {"explicit", torn},
        {"explicit_triangles",
         with(torn, {"Mesh/type=crossed triangles", "Mesh/cells=6, 6",
                     "Interface: all/friction=0.3", "Time/end=16 ns"})},
        {"explicit_refined", refined},
        {"explicit_bisected", bisected},
        {"explicit_viscous",
         with(torn, {"Material: bulk/shear viscosity=20 mPa*s",
                     "Material: bulk/bulk viscosity=50 mPa*s"})},
        {"explicit_pressure",
         with(torn, {"Interface: all/crack pressure=20 MPa * t / 9 ns",
                     "Interface: all/pressure threshold=0.5"})},
        {"explicit_rigid",
         {benchmark("rigid_punch"), {"Constants/n=6", "Time/end=15 us"}}},
        {"rubbing", rubbing},
        {"rubbing_iterations",
         with(rubbing, {"Constants/n=4", "Mesh/cells=4, 4", assembled, cg})},
        {"interior_point", with(rubbing, {"Solver/method=interior point"})},
        {"ball", {scene("ball"), {"Time/end=0.6 s"}}},
        {"stop", {scene("stop"), {}}},
        {"dilatancy", {scene("dilatancy"), {}}},
        {"wear", {scene("wear"), {}}},
        {"heap", {benchmark("falling_wall"), {"Time/end=60 ms"}}},
        {"heavy_top", {scene("heavy_top"), {"Time/end=0.1 s"}}},
        {"impactor",
         {benchmark("impactor"), {"Body: beam/cells=20, 2", "Time/end=60 us"}}},
        {"explicit_large",
         {benchmark("projectile"),
          {"Body: plate/cells=4, 20", "Time/end=20 us"}}},
        {"explicit_plastic",
         {benchmark("projectile"),
          {"Body: plate/cells=4, 20", "Material: steel/model=viscoplastic",
           "Material: steel/yield stress=50 MPa",
           "Material: steel/viscosity=100 Pa*s", "Time/end=20 us"}}},
        {"explicit_turning",
         {benchmark("rigid_projectile"),
          {"Body: plate/cells=4, 20", "Time/end=20 us"}}},
        {"explicit_flowing",
         {scene("plastic_bar_explicit"), {"Time/end=40 us"}}},
        {"textured_polycrystal",
         {benchmark("textured_polycrystal"),
          {"Mesh/cells=1500", "Mesh/grains=8", "Time/end=0.2 us"}}},
        {"plastic_bar", {scene("plastic_bar"), {"Time/end=40 us"}}},
        {"plastic_breaking", with(breaking, plastic)},
        {"viscoplastic_large",
         with(with(breaking, plastic),
              {"motion=large", "Material: PMMA/model=viscoplastic",
               "Material: PMMA/viscosity=100 Pa*s", "Time/end=60 us"})},
        {"automatic_steps",
         with(breaking, {"Time/step=auto", "Time/end=40 us"})},
        {"quasi_static", {scene("static_michel"), {}}},
        {"quasi_static_extrinsic", {scene("static_extrinsic"), {}}, 0.3},
        {"jump_in_time",
         {scene("static_michel"),
          {"Time/at solution jump=dynamic", "Time/dynamic step=10 courant"}}},
        {"jump_in_time_before",
         {scene("static_michel"),
          {"Time/at solution jump=dynamic", "Time/dynamic step=10 courant"}},
         0.01},
        {"equilibrium_first", {scene("static_start"), {}}},
        {"arkode_explicit",
         {scene("mode"),
          {"Time/scheme=arkode", "Time/pairs=explicit", "Time/step=20 us"}}},
        {"arkode_implicit",
         {scene("mode"),
          {"Time/scheme=arkode", "Time/pairs=implicit", "Time/step=20 us"}}},
        {"arkode_driven",
         {scene("manufactured"),
          {"Time/scheme=arkode", "Time/end=0.1 ms", "Time/step=5 us",
           "Constants/n=4"}}},
        {"damped_wave", {scene("damped_wave"), {"Constants/n=8"}}},
        {"graded", {scene("graded_bar"), {}}},
        {"transverse_wave", {scene("transverse_wave"), {"Constants/n=8"}}},
        {"xu_needleman",
         with(midplane, {"Interface: midline/law=xu-needleman",
                         "Interface: midline/intact faces=spring"})},
        {"in_space",
         {scene("bar_wall"),
          {"dimension=3", "Mesh/type=brick", "Mesh/cells=8, 2, 2",
           "Mesh/lower corner=0, 0, 0", "Mesh/upper corner=10 m, 1 m, 1 m",
           "Mesh/distortion=0.2", "Obstacle: wall/point=-5 m, 0, 0",
           "Obstacle: wall/normal=1, 0, 0"}}},
        {"broken_in_space",
         {benchmark("broken_brick"),
          {"Constants/n=3", "Mesh/cells=3, 3, 3", "Time/end=3"}}},
        {"bimodular", {scene("bimodular"), {"Mesh/cells=30, 1"}}},
        {"plate_impact", {scene("plate_impact"), {}}},
        {"crack_path", {scene("crack_path"), {}}},
        {"adaptive",
         {benchmark("dcb"),
          {"Mesh/cells=20, 4", "Discretization/degree=1", "Time/end=500 us",
           "Time/step=5 us"}}},
        {"adaptive_springs",
         with(breaking, {"Time/end=60 us", "Adaptivity/levels=1",
                         "Adaptivity/coarsen every steps=5",
                         "Indicator: front/type=process zone"})},
    };

    class RestartTest : public testing::TestWithParam<RestartRow>
    {
    };

    /** Of the uninterrupted run @p a and the resumed one @p b. */
    void expect_same(const Result &a, const Result &b)
    {
      EXPECT_TRUE(a.history_text == b.history_text)
          << "histories differ by " << energy_difference(a.history, b.history);
      EXPECT_EQ(a.summary["errors"], b.summary["errors"]);
      for (const char *name :
           {"energy", "dissipated", "steps", "final_time", "fragments",
            "ledger_defect_max", "residual_max", "penetration_max",
            "penetration_bound", "rigid_drift_max"})
        EXPECT_EQ(a.summary[name], b.summary[name]) << name;
      for (const char *name :
           {"newton", "krylov", "gauss_seidel_sweeps", "rejected_steps",
            "released_bonds", "redone_steps", "solver_calls"})
        EXPECT_EQ(a.summary["counters"].value(name, 0.),
                  b.summary["counters"].value(name, 0.))
            << name;
      for (const char *name : {"fields.pvd", "interfaces.pvd", "fields.xdmf",
                               "interfaces.xdmf", "fragments.csv"})
        EXPECT_EQ(read_text(a.directory / name), read_text(b.directory / name));
      EXPECT_TRUE(snapshots(a.directory, "fields") ==
                  snapshots(b.directory, "fields"));
      EXPECT_TRUE(snapshots(a.directory, "interfaces") ==
                  snapshots(b.directory, "interfaces"));
    }
  } // namespace

  TEST_P(RestartTest, IsTheSameToTheLastBit)
  {
    const RestartRow &row = GetParam();
    const Workspace workspace;
    const Result whole = run(workspace, "whole", row.launch);
    ASSERT_TRUE(whole.completed()) << whole.description();
    const auto steps = unsigned(row.share * whole.number("steps")) + 1;
    ASSERT_LT(steps, whole.number("steps"));
    // the last one is that of the end, and the one before it on the way
    const Launch stored = storing(row.launch, steps);
    const Result before = run(workspace, "resumed", stored);
    ASSERT_TRUE(before.completed()) << before.description();
    EXPECT_TRUE(whole.history_text == before.history_text)
        << "to store a run changes nothing";
    fs::remove(newest(before.directory));
    const Result after = resume(workspace, "resumed", stored);
    ASSERT_TRUE(after.completed()) << after.description();
    EXPECT_EQ(after.counter("resumed"), 1.);
    expect_same(whole, after);
  }

  INSTANTIATE_TEST_SUITE_P(Table, RestartTest, testing::ValuesIn(rows),
                           [](const auto &info) { return info.param.name; });

  // On two ranks bit for bit, and from one number of ranks to another.
  TEST(Restart, OnSeveralRanks)
  {
    for (const Launch &launch : {breaking, bonded, rubbing, midplane}) {
      SCOPED_TRACE(launch.file.string());
      for (const auto &[first, second] :
           {std::pair{2u, 2u}, std::pair{1u, 2u}, std::pair{3u, 1u}}) {
        SCOPED_TRACE(std::to_string(first) + " ranks, then " +
                     std::to_string(second));
        const Workspace workspace;
        Launch before = with(launch, {"Solver/tolerance=1e-11"}),
               after = before;
        before.ranks = first;
        after.ranks = second;
        const Result whole = good_run(workspace, "whole", before);
        Result resumed;
        ASSERT_NO_FATAL_FAILURE(
            go_on(workspace, before, after, whole, resumed));
        EXPECT_TRUE(first != second ||
                    whole.history_text == resumed.history_text);
        expect_below("energies",
                     energy_difference(whole.history, resumed.history), 1e-9);
      }
    }
  }

  // Large motions and joined cells do not know how many ranks there are: rigid
  // bodies, surfaces and what they keep go from two to three, plastic cells
  // from one to two, nodes that have split from two to one and from one to
  // three.
  TEST(Restart, OnOtherRanksBitForBit)
  {
    const std::vector<std::string> joined = {
        "Time/scheme=explicit",
        "Time/step=auto",
        "Interface: all/friction=0.3",
        "Boundary: left/velocity x=if(t<8 ns,-2 m/s,2 m/s)",
        "Boundary: right/velocity x=if(t<8 ns,2 m/s,-2 m/s)",
        "Time/end=14 ns"};
    const std::vector<std::tuple<Launch, unsigned int, unsigned int>> rows = {
        {with(with(torn, joined), {"Mesh/type=crossed triangles"}), 2, 1},
        {with(torn, joined), 1, 3},
        {with(refined, joined), 2, 3},
        {with(with(torn, joined),
              {"motion=large", "Material: bulk/model=neo-hookean"}),
         2, 3},
        {with(with(torn, joined),
              {"motion=large", "Material: bulk/model=j2 plastic",
               "Material: bulk/yield stress=250 MPa"}),
         2, 1},
        {{benchmark("projectile"),
          {"Body: plate/cells=4, 20", "Time/end=20 us"}},
         1,
         2},
        {{benchmark("push_back"), {"Mesh/cells=6, 6", "Time/end=17 ns"}}, 2, 3},
        {{benchmark("heap_of_bricks"), {"Time/end=0.1 s"}}, 3, 1},
        {{scene("plastic_bar"), {"Time/end=10 us"}}, 1, 2}};
    for (const auto &[launch, first, second] : rows) {
      SCOPED_TRACE(launch.file.string());
      const Workspace workspace;
      Launch before = launch, after = launch;
      before.ranks = first;
      after.ranks = second;
      const Result whole = good_run(workspace, "whole", launch);
      Result resumed;
      ASSERT_NO_FATAL_FAILURE(go_on(workspace, before, after, whole, resumed));
      EXPECT_TRUE(whole.history_text == resumed.history_text)
          << energy_difference(whole.history, resumed.history);
    }
  }

  // What the shell sees of Ctrl-C, and that nothing is lost by it.
  TEST(Restart, AfterSignals)
  {
    const Workspace workspace;
    const Launch launch = with(breaking, {"Time/step=0.05 us"});
    const Result whole = good_run(workspace, "whole", launch);
    const fs::path directory = workspace.path() / "stopped";
    std::vector<std::string> more;
    long rows = 0;
    for (const int signal : {SIGINT, SIGTERM}) {
      Process process(command_of(launch, directory, more), workspace.path());
      ASSERT_TRUE(wait_for_rows(directory, rows + 50));
      process.send(signal);
      const Outcome outcome = process.wait(30.);
      EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
      EXPECT_TRUE(fs::exists(newest(directory)));
      rows = long(History(read_text(directory / "history.csv")).size());
      more = {"--resume"};
    }
    const Result after = resume(workspace, "stopped", launch);
    ASSERT_TRUE(after.completed()) << after.description();
    EXPECT_EQ(after.counter("resumed"), 2.);
    expect_same(whole, after);
  }

  // Every few steps, whenever that is.
  TEST(Restart, ByWallTime)
  {
    const Workspace workspace;
    const Result whole = good_run(workspace, "whole", midplane);
    const Launch launch = with(midplane, {"Output/checkpoint every=20 ms"});
    const Result stored = run(workspace, "resumed", launch);
    ASSERT_TRUE(stored.completed()) << stored.description();
    EXPECT_EQ(whole.history_text, stored.history_text);
    fs::rename(previous(stored.directory), newest(stored.directory));
    const Result after = resume(workspace, "resumed", launch);
    ASSERT_TRUE(after.completed()) << after.description();
    expect_same(whole, after);
  }

  // Words that are called otherwise today: the same run, which goes on in
  // either.
  TEST(Restart, AfterWordsHaveChanged)
  {
    const Workspace workspace;
    const Launch now = storing(
                     with(midplane,
                          {"Time/step=0.6 courant", "Time/maximum bisections=5",
                           "Solver/method=cascade", "Solver/path=local"}),
                     20),
                 former = storing(
                     with(midplane,
                          {"Time/step=0.6 courant", "Time/maximum halvings=5",
                           "Solver/method=chain", "Solver/path=element-wise"}),
                     20);
    const Result whole = good_run(workspace, "whole", now);
    const Result stored = good_run(workspace, "resumed", former);
    EXPECT_EQ(whole.history_text, stored.history_text);
    EXPECT_EQ(whole.outcome.err.find("note:"), std::string::npos);
    for (const std::string name : {"bisections", "cascade", "local"}) {
      const std::string note = name + "` today; both words work";
      const auto first = stored.outcome.err.find(note);
      EXPECT_NE(first, std::string::npos) << stored.outcome.err;
      EXPECT_EQ(stored.outcome.err.find(note, first + 1), std::string::npos);
    }
    fs::rename(previous(stored.directory), newest(stored.directory));
    const Result after = resume(workspace, "resumed", now);
    ASSERT_TRUE(after.completed()) << after.description();
    EXPECT_EQ(after.outcome.err.find("changed since the checkpoint"),
              std::string::npos)
        << after.outcome.err;
    EXPECT_EQ(after.history_text, whole.history_text);
  }

  // Exit code 3 stores the last good state: a solver that can goes on from it.
  // Explicit steps keep their length on the way to another end.
  TEST(Restart, ExplicitStepsToAnotherEnd)
  {
    const Workspace workspace;
    const Launch first = {benchmark("fracture_extrinsic"),
                          {"Mesh/cells=8, 8", "Time/end=4 ns",
                           "Time/scheme=explicit", "Time/step=auto",
                           "Output/checkpoint every steps=10"}};
    const Result before = good_run(workspace, "run", first);
    Launch longer = first;
    longer.set[1] = "Time/end=7.77 ns";
    const Result after = resume(workspace, "run", longer);
    ASSERT_TRUE(after.completed()) << after.description();
    const auto &t = after.history["time"];
    const double h = before.history["time"][1];
    EXPECT_NEAR(t.back() - t[t.size() - 2], h, 1e-9 * h);
    EXPECT_GE(t.back(), 7.77e-9 * (1. - 1e-12));
    EXPECT_LT(t.back(), 7.77e-9 + h);
    EXPECT_LT(
        after.summary["certificate"]["lines"]["given by time scheme"]["value"],
        1e-14);
    Launch shorter = longer;
    shorter.set[3] = "Time/step=1 ps";
    const Result refused = resume(workspace, "run", shorter);
    EXPECT_EQ(refused.outcome.exit_code, 1);
    EXPECT_NE(refused.outcome.err.find("Time/step"), std::string::npos);
  }

  TEST(Restart, AfterAStepThatFailed)
  {
    const Workspace workspace;
    const Launch good = {scene("ball"),
                         {"Obstacle: floor/friction=0.5", "Time/end=1 s",
                          "Material: ball/initial velocity x=2 m/s"}};
    const Launch bad =
        with(good, {"Solver/method=dual newton", "Solver/maximum iterations=1",
                    "Time/maximum bisections=0"});
    const Result failed = run(workspace, "ball", bad);
    EXPECT_EQ(failed.outcome.exit_code, 3) << failed.description();
    const Result again = resume(workspace, "ball", bad);
    EXPECT_EQ(again.outcome.exit_code, 3);
    EXPECT_EQ(again.history_text, failed.history_text);
    const Result result = resume(workspace, "ball", good);
    ASSERT_TRUE(result.completed()) << result.description();
    EXPECT_EQ(result.history_text.compare(0, failed.history_text.size(),
                                          failed.history_text),
              0);
    EXPECT_LE(result.number("ledger_defect_max"), 1e-9);
    EXPECT_GT(result.dissipated("impact"), 0.);
  }

  // SIGKILL at random moments, as often as NSFD_KILLS says.
  TEST(Restart, AfterKillsAtRandom)
  {
    const char *wanted = std::getenv("NSFD_KILLS");
    const unsigned int kills = wanted ? unsigned(std::atoi(wanted)) : 4;
    const Workspace workspace;
    const Launch launch = storing(with(breaking, {"Time/step=0.05 us"}), 3);
    const Result whole = good_run(workspace, "whole", launch);
    const fs::path directory = workspace.path() / "killed";
    std::mt19937 random(7);
    std::uniform_real_distribution<double> share(0., 1.);
    unsigned int done = 0, fresh = 0, finished = 0;
    while (done < kills) {
      const bool starts =
          !fs::exists(newest(directory)) && !fs::exists(previous(directory));
      fresh += starts;
      Process process(
          command_of(launch, directory, {starts ? "--force" : "--resume"}),
          workspace.path());
      // from before the first step to well into them
      std::this_thread::sleep_for(
          std::chrono::milliseconds(int(300. + 1500. * share(random))));
      if (process.is_running()) {
        process.send(SIGKILL);
        EXPECT_EQ(process.wait(10.).exit_code, 128 + SIGKILL);
        ++done;
      } else {
        const Outcome outcome = process.wait(1.);
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        Result result;
        result.directory = directory;
        EXPECT_EQ(read_text(directory / "history.csv"), whole.history_text);
        fs::remove_all(directory);
        ++finished;
      }
    }
    const bool starts =
        !fs::exists(newest(directory)) && !fs::exists(previous(directory));
    const Outcome last = Process(command_of(launch, directory,
                                            {starts ? "--force" : "--resume"}),
                                 workspace.path())
                             .wait(60.);
    EXPECT_EQ(last.exit_code, 0) << last.err;
    EXPECT_EQ(read_text(directory / "history.csv"), whole.history_text);
    std::cout << "  " << done << " kills, " << fresh << " runs from the start, "
              << finished + 1 << " completed\n";
  }
} // namespace end_to_end::test_restart
