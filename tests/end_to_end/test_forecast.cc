#include "program.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <ostream>
#include <regex>

// What --check says of time and memory, and how a run ends.

namespace end_to_end::test_forecast
{
  namespace
  {
    using Words = std::vector<std::string>;

    struct Row {
      std::string name, file;
      Words set;
      std::string path; ///< what is said of it
    };

    void PrintTo(const Row &row, std::ostream *stream) { *stream << row.name; }

    const std::vector<Row> rows = {
        {"implicit", torn_plate().string(), {}, "path       local, blocks of"},
        {"long_steps",
         scene("midplane").string(),
         {"Time/step=20 courant"},
         "path       assembled, one system"},
        {"explicit_nodes",
         benchmark("fracture_extrinsic").string(),
         {},
         "path       nodes, single nodes"},
        {"rigid", scene("roll").string(), {}, "path       local, blocks of"},
        {"loads",
         scene("pull_out").string(),
         {},
         ", of section Time: equilibria from one load to the next"},
        {"after_an_equilibrium",
         scene("static_start").string(),
         {},
         "path       local, blocks of"},
        {"smooth",
         scene("mode").string(),
         {"Time/scheme=arkode"},
         "the error of a step is bounded"},
        {"mesh_that_changes",
         benchmark("branching").string(),
         {},
         "path       assembled, one system of all bodies, because faces are "
         "joined"}};

    class ForecastTest : public testing::TestWithParam<Row>
    {
    };
  } // namespace

  TEST_P(ForecastTest, SaysTimeAndMemoryAndWritesNothing)
  {
    const Workspace workspace;
    Words words = {GetParam().file, "--check"};
    for (const std::string &one : GetParam().set)
      words.insert(words.end(), {"--set", one});
    const Outcome outcome = nsfd(workspace, words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string &out = outcome.out;
    EXPECT_TRUE(std::regex_search(
        out, std::regex("\n  time       (at least )?about [0-9.]+ "
                        "(s|min|h|d)\\b")))
        << out;
    EXPECT_TRUE(std::regex_search(
        out, std::regex("\n +set-up [0-9.]+ (s|min).* steps of [0-9.]+ (s|ms|"
                        "µs|ns)\\b")))
        << out;
    EXPECT_TRUE(
        std::regex_search(out, std::regex("\n  memory     about [0-9]+ MB\n")))
        << out;
    EXPECT_NE(out.find("\n  scheme     "), std::string::npos) << out;
    EXPECT_NE(out.find(GetParam().path), std::string::npos) << out;
    EXPECT_EQ(files_below(workspace.path()), Words());
  }

  INSTANTIATE_TEST_SUITE_P(Scenes, ForecastTest, testing::ValuesIn(rows),
                           [](const auto &info) { return info.param.name; });

  // The number of steps is that of the run, whose first steps are the same.
  TEST(Forecast, OfAShortRunIsTheRun)
  {
    const Workspace workspace;
    const Outcome check = nsfd(workspace, {scene("stop").string(), "--check"});
    ASSERT_EQ(check.exit_code, 0) << check.err;
    EXPECT_NE(check.out.find(", 250 steps of "), std::string::npos)
        << check.out;
    EXPECT_NE(check.out.find("all steps were tried"), std::string::npos)
        << check.out;
  }

  TEST(Forecast, OnTwoRanks)
  {
    const Workspace workspace;
    const Outcome check =
        Process({NSFD_MPIRUN, "--allow-run-as-root", "--oversubscribe", "-n",
                 "2", NSFD_PROGRAM, scene("midplane").string(), "--check"},
                workspace.path())
            .wait(120.);
    EXPECT_EQ(check.exit_code, 0) << check.err;
    EXPECT_NE(check.out.find("\n  time       about "), std::string::npos)
        << check.out;
    EXPECT_EQ(files_below(workspace.path()), Words());
  }

  // Its errors are all that is said of a scene that cannot be run.
  TEST(Forecast, NoneOfAWrongScene)
  {
    const Workspace workspace;
    const Outcome check = nsfd(
        workspace, {scene("stop").string(), "--check", "--set", "Time/ende=1"});
    EXPECT_EQ(check.exit_code, 1);
    EXPECT_EQ(check.out, "");
    EXPECT_NE(check.err.find("`ende`"), std::string::npos) << check.err;
  }

  TEST(Forecast, ExplicitStepsThatAreTooShort)
  {
    const Workspace workspace;
    const Outcome check =
        nsfd(workspace, {benchmark("fracture_extrinsic").string(), "--check",
                         "--set", "Time/step=0.05 courant"});
    EXPECT_EQ(check.exit_code, 0) << check.err;
    EXPECT_NE(check.out.find("change: `set step = auto`"), std::string::npos)
        << check.out;
  }

  // Certificate, what happened, where the pictures are; costs if asked for.
  TEST(EndOfARun, InThisOrder)
  {
    const Workspace workspace;
    const Words call = {scene("stop").string(), "--force"};
    const std::string plain = nsfd(workspace, call).out;
    const auto at = [](const std::string &text, const char *part) {
      const std::size_t place = text.rfind(part);
      EXPECT_NE(place, std::string::npos) << part << "\n" << text;
      return place;
    };
    EXPECT_LT(at(plain, "certificate: "), at(plain, "250 steps to t = "));
    EXPECT_LT(at(plain, "250 steps to t = "), at(plain, "energy at the end:"));
    EXPECT_LT(at(plain, "energy at the end:"), at(plain, "pictures: "));
    EXPECT_EQ(plain.find("MB"), std::string::npos) << plain;
    const std::string all =
        nsfd(workspace, {call[0], call[1], "--verbose"}).out;
    EXPECT_LT(at(all, "energy at the end:"), at(all, "s of CPU, at most "));
    EXPECT_LT(at(all, "s of CPU, at most "), at(all, "pictures: "));
  }
} // namespace end_to_end::test_forecast
