#include "../wall/drawn_scene.h"
#include "../wall/verdict.h"
#include "program.h"

#include <gtest/gtest.h>

#include <fstream>

// Scenes of the wall, tests/wall, with fixed seeds: one or two of every kind.
// tests/benchmarks/wall_of_scenes.cc runs them by the hundred.

namespace end_to_end::test_wall
{
  namespace
  {
    struct Seed {
      unsigned int seed;
      const char *kind; ///< another one: the generator draws other scenes now
    };

    void PrintTo(const Seed &seed, std::ostream *out)
    {
      *out << seed.seed << ": " << seed.kind;
    }

    class WallTest : public testing::TestWithParam<Seed>
    {
    };

    TEST_P(WallTest, GoesThrough)
    {
      const Workspace workspace;
      const wall::DrawnScene scene = wall::draw_scene(GetParam().seed);
      EXPECT_EQ(scene.kind, GetParam().kind);
      for (const auto &[name, text] : scene.files)
        write_text(workspace.path() / name, text);
      write_text(workspace.path() / "scene.prm", scene.text);
      const Outcome outcome =
          nsfd(workspace,
               {"scene.prm", "--set", "Output/directory=results", "--force"});
      write_text(workspace.path() / "log", outcome.out + outcome.err);
      wall::Ended ended;
      ended.exit_code = outcome.exit_code;
      const wall::Verdict verdict =
          wall::judge(workspace.path() / "results", workspace.path() / "log",
                      ended, scene.keeps_momentum, scene.end);
      EXPECT_TRUE(verdict.through) << verdict.message << "\n" << scene.text;
    }

    INSTANTIATE_TEST_SUITE_P(
        Seeds, WallTest,
        testing::Values(Seed{20, "large auto breakable alone"},
                        Seed{72, "large auto breakable contact"},
                        Seed{136, "large auto elastic contact"},
                        Seed{108, "large auto rigid contact"},
                        Seed{3, "large explicit breakable alone"},
                        Seed{17, "large explicit breakable alone"},
                        Seed{30183, "large auto mixed contact"},
                        Seed{9, "large explicit breakable contact"},
                        Seed{30210, "large explicit breakable contact"},
                        // faces that hold at one end and slide at the other
                        Seed{30070, "large explicit mixed contact"},
                        Seed{30258, "large explicit mixed contact"},
                        // corners next to faces that begin to open, and close
                        Seed{79, "large explicit breakable contact"},
                        Seed{41076, "large explicit breakable contact"},
                        // acute corners that cut through each other
                        Seed{30088, "large explicit breakable contact"},
                        Seed{30290, "large explicit breakable contact"},
                        // a corner that slides past the end of a facet
                        Seed{60025, "large explicit breakable contact"},
                        // flush blocks that close without having touched
                        Seed{60237, "large auto elastic contact"},
                        // tips in the mouth of a crack
                        Seed{60313, "large moreau-jean breakable contact"},
                        // a corner that goes on to the next cell of a plate
                        Seed{60120, "large moreau-jean mixed contact"},
                        // tips that are in each other, and turn
                        Seed{30243, "large explicit breakable contact"},
                        // a surface that bulges between its nodes
                        Seed{30473, "large explicit mixed contact"},
                        // edges where corners have touched
                        Seed{30371, "large explicit breakable contact"},
                        // what tolerances leave adds up
                        Seed{30372, "large explicit elastic contact"},
                        Seed{30324, "small symplectic breakable contact"},
                        Seed{30491, "small moreau-jean elastic contact"},
                        // steps that change their length
                        Seed{30075, "small symplectic mixed contact"},
                        // joints that hold each other
                        Seed{30306, "small moreau-jean mixed contact"},
                        // rigid cells that rigid cells follow, and friction
                        Seed{41189, "small moreau-jean mixed contact"},
                        // shorter steps would give more than long ones do
                        Seed{41128, "large auto elastic contact"},
                        // a rigid body that is held at rest, and pinned
                        Seed{41062, "large auto rigid contact"},
                        // more than the tolerance of a step
                        Seed{30384, "small arkode elastic alone"},
                        // broken points of faces that hold elsewhere
                        Seed{30342, "large explicit breakable alone"},
                        // driven by half a body, speeds of the softest one
                        Seed{30221, "large explicit elastic alone"},
                        Seed{30124, "large explicit breakable contact"},
                        Seed{30023, "large explicit mixed contact"},
                        Seed{30340, "large explicit breakable contact"},
                        Seed{16, "large explicit breakable contact"},
                        Seed{103, "large explicit elastic alone"},
                        Seed{35, "large explicit elastic contact"},
                        Seed{89, "large explicit elastic contact"},
                        Seed{30293, "large explicit elastic contact"},
                        Seed{7, "large explicit mixed contact"},
                        Seed{31, "large explicit mixed contact"},
                        Seed{20059, "large explicit mixed contact"},
                        Seed{2, "large explicit rigid contact"},
                        Seed{11, "large explicit rigid contact"},
                        Seed{20024, "large explicit rigid contact"},
                        Seed{20076, "large explicit rigid contact"},
                        Seed{30255, "large explicit rigid contact"},
                        Seed{27, "large moreau-jean breakable alone"},
                        Seed{30057, "large moreau-jean breakable alone"},
                        Seed{63, "large moreau-jean breakable contact"},
                        // broken points that slide beside one that holds
                        Seed{30264, "large moreau-jean breakable contact"},
                        // a rigid block that is driven along its top
                        Seed{30370, "large moreau-jean mixed contact"},
                        // softening points that slide and turn with their face
                        Seed{30346, "large moreau-jean breakable contact"},
                        Seed{30388, "large moreau-jean breakable contact"},
                        Seed{30016, "large moreau-jean breakable contact"},
                        Seed{21, "large moreau-jean elastic contact"},
                        Seed{23, "large moreau-jean mixed contact"},
                        Seed{41, "large moreau-jean rigid contact"},
                        Seed{20049, "small arkode elastic alone"},
                        Seed{25, "small auto breakable contact"},
                        Seed{36, "small explicit breakable contact"},
                        Seed{56, "small explicit breakable alone"},
                        Seed{113, "small explicit elastic contact"},
                        Seed{8, "small explicit mixed contact"},
                        Seed{45, "small moreau-jean breakable contact"},
                        Seed{160, "small moreau-jean elastic alone"},
                        Seed{155, "small moreau-jean mixed contact"},
                        Seed{44, "small moreau-jean rigid contact"},
                        Seed{87, "small quasi-static breakable alone"},
                        Seed{15, "small symplectic elastic contact"},
                        Seed{357, "small symplectic elastic contact"},
                        Seed{30032, "small symplectic breakable contact"}),
        [](const testing::TestParamInfo<Seed> &info) {
          return std::to_string(info.param.seed);
        });

    /** A run with one line of its certificate, and what it moved. */
    struct WrittenRun {
      explicit WrittenRun(const std::filesystem::path &folder) : folder_(folder)
      {
        std::filesystem::create_directories(folder);
        line("given by impact", "ok", 1e-12);
        fragments(3.);
        write_text(folder / "history.csv", "step,kinetic\n0,9\n9,5\n");
      }
      void line(const std::string &name, const std::string &verdict,
                const double value) const
      {
        nlohmann::json summary;
        summary["final_time"] = 1.;
        summary["failure"] = nullptr;
        summary["certificate"]["ok"] = true;
        summary["certificate"]["lines"][name] = {
            {"verdict", verdict}, {"value", value}, {"bound", 1e-9}};
        write_text(folder_ / "summary.json", summary.dump());
      }
      /** 2 kg at 3 m/s before. */
      void fragments(const double speed) const
      {
        write_text(folder_ / "fragments.csv",
                   "step,fragment,mass,vx,vy\n0,0,2,3,0\n9,0,1," +
                       std::to_string(2. * speed) + ",1\n9,1,1,0,-1\n");
      }
      wall::Verdict verdict(const int exit_code,
                            const bool keeps_momentum) const
      {
        wall::Ended ended;
        ended.exit_code = exit_code;
        return wall::judge(folder_, folder_ / "log", ended, keeps_momentum, 1.);
      }

    private:
      std::filesystem::path folder_;
    };
  } // namespace

  TEST(Wall, JudgesWhatWentWrong)
  {
    const Workspace workspace;
    const WrittenRun run(workspace.path() / "run");
    EXPECT_TRUE(run.verdict(0, true).through);
    EXPECT_FALSE(run.verdict(3, true).through);
    EXPECT_FALSE(run.verdict(139, true).through);
    EXPECT_TRUE(run.verdict(1, true).refused);
    run.fragments(2.999);
    EXPECT_TRUE(run.verdict(0, false).through) << "a load acts";
    EXPECT_FALSE(run.verdict(0, true).through);
    EXPECT_TRUE(run.verdict(0, true).silent) << "its certificate is ok";
    run.fragments(3.);
    for (const char *name :
         {"given by friction", "given by joints", "given by supports",
          "balance residual", "penetration"}) {
      run.line(name, "not ok", 1e-6);
      const wall::Verdict verdict = run.verdict(0, true);
      EXPECT_FALSE(verdict.through) << name;
      EXPECT_NEAR(verdict.worst, 1e3, 1e-6) << name;
      EXPECT_NE(verdict.message.find(name), std::string::npos);
    }
    // a bound of the wall
    run.line("given by large motion", "ok", 9e-4);
    EXPECT_TRUE(run.verdict(0, true).through);
    run.line("given by large motion", "ok", 2e-3);
    EXPECT_FALSE(run.verdict(0, true).through);
    EXPECT_TRUE(run.verdict(0, true).silent);
    // what the certificate says of accuracy is no failure
    run.line("uniqueness", "not ok", 3.);
    EXPECT_TRUE(run.verdict(0, true).through);
  }

  TEST(Wall, DrawsTheSameSceneForASeed)
  {
    for (const unsigned int seed : {1u, 77u, 4000u})
      EXPECT_EQ(wall::draw_scene(seed).text, wall::draw_scene(seed).text);
    EXPECT_NE(wall::draw_scene(1).text, wall::draw_scene(2).text);
  }
} // namespace end_to_end::test_wall
