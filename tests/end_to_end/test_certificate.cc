#include "compare.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <algorithm>

// What a run says of itself when it ends.

namespace end_to_end
{
  namespace
  {
    std::string verdict(const Result &result, const std::string &line)
    {
      const auto &lines = result.summary.at("certificate").at("lines");
      return lines.contains(line)
                 ? lines.at(line).at("verdict").get<std::string>()
                 : "no such line";
    }

    /** The last lines that a run prints. */
    std::string last_lines(const Workspace &workspace,
                           const std::filesystem::path &file,
                           const std::vector<std::string> &settings = {})
    {
      std::vector<std::string> arguments = {file.string(), "--set",
                                            "Output/report=false"};
      for (const std::string &setting : settings)
        arguments.insert(arguments.end(), {"--set", setting});
      const std::string out = nsfd(workspace, arguments).out;
      const std::size_t begin = out.rfind("certificate: ");
      return begin == std::string::npos ? out : out.substr(begin);
    }
  } // namespace

  TEST(Certificates, OfAGoodRun)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "ball", {scene("ball"), {}, 1, true});
    EXPECT_TRUE(result.summary.at("certificate").at("ok").get<bool>());
    for (const char *line : {"end", "residual", "penetration", "ledger defect",
                             "created", "uniqueness", "taken again"})
      EXPECT_EQ(verdict(result, line), "ok") << line;
    EXPECT_EQ(verdict(result, "cohesive zone"), "none");
    const auto &residual =
        result.summary.at("certificate").at("lines").at("residual");
    EXPECT_EQ(residual.at("value"), result.summary.at("residual_max"));
    EXPECT_EQ(residual.at("bound"), 1e-8);
    const std::string last = last_lines(workspace, scene("ball"));
    EXPECT_EQ(last.substr(0, last.find('\n')), "certificate: ok");
    EXPECT_EQ(std::count(last.begin(), last.end(), '\n'), 9)
        << "nothing follows\n"
        << last;
    EXPECT_NE(read_text(result.directory / "report.html").find("certificate"),
              std::string::npos);
  }

  TEST(Certificates, OfAStepBeyondUniqueness)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "long_steps",
                 {scene("midplane"), {"Time/step=2 crossings"}});
    ASSERT_GT(result.counter("steps_beyond_uniqueness"), 0.);
    EXPECT_EQ(verdict(result, "uniqueness"), "not ok");
    const std::string last =
        last_lines(workspace, scene("midplane"), {"Time/step=2 crossings"});
    EXPECT_NE(last.find("set step = auto"), std::string::npos) << last;
    EXPECT_FALSE(result.summary.at("certificate").at("ok").get<bool>());
  }

  TEST(Certificates, OfEquilibria)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "static", {scene("static_crossed")});
    EXPECT_EQ(verdict(result, "imbalance"), "ok");
    EXPECT_EQ(verdict(result, "solution jumps"), "ok");
    EXPECT_EQ(verdict(result, "residual"), "no such line")
        << "no step in time";
  }

  TEST(Certificates, OfAnIntegrator)
  {
    const Workspace workspace;
    const Result result =
        good_run(workspace, "smooth",
                 {scene("mode"),
                  {"Time/scheme=arkode", "Time/pairs=explicit",
                   "Time/step=20 us"}});
    EXPECT_EQ(verdict(result, "residual"), "not measured");
    EXPECT_FALSE(result.summary.at("certificate").at("ok").get<bool>());
    EXPECT_EQ(result.summary.at("certificate").at("verdict"),
              "ok as far as measured, 1 of 8 lines are not");
  }

  // Corners slide over the ends of bodies that turn, and off them: no point is
  // deeper than it came in by.
  TEST(Certificates, OfAFallingWall)
  {
    const Workspace workspace;
    const Result result = good_run(workspace, "wall",
                                   {benchmark("falling_wall"),
                                    {"Time/end=0.5 s"}});
    EXPECT_GT(result.number("penetration_max"), 1e-4);
    EXPECT_EQ(verdict(result, "penetration"), "ok");
    EXPECT_EQ(verdict(result, "ledger defect"), "ok");
  }

  TEST(Certificates, OfAFailedRun)
  {
    const Workspace workspace;
    const std::vector<std::string> too_hard = {
        "Solver/maximum iterations=1", "Solver/method=dual newton",
        "Time/maximum halvings=0", "Solver/tolerance=1e-13"};
    const Result result = run(workspace, "failed", {quickstart(), too_hard});
    ASSERT_EQ(result.outcome.exit_code, 3) << result.description();
    EXPECT_EQ(verdict(result, "end"), "not ok");
    const std::string last = last_lines(workspace, quickstart(), too_hard);
    EXPECT_NE(last.find("not reached: the step of"), std::string::npos) << last;
  }

  TEST(Certificates, SurviveARestart)
  {
    const Workspace workspace;
    const Launch what = {quickstart(),
                         {"Mesh/cells=12, 9", "Time/step=0.8 us",
                          "Time/end=40 us"}};
    const Result whole = good_run(workspace, "whole", what);
    const Launch stored = storing(what, 20);
    good_run(workspace, "resumed", stored);
    std::filesystem::remove(newest(workspace.path() / "resumed"));
    const Result after = resume(workspace, "resumed", stored);
    ASSERT_TRUE(after.completed()) << after.description();
    EXPECT_EQ(whole.summary.at("certificate"),
              after.summary.at("certificate"));
  }

  TEST(Certificates, AreNotOnAQuietTerminal)
  {
    const Workspace workspace;
    const Outcome outcome = nsfd(
        workspace, {scene("ball").string(), "--quiet", "--set", "Time/end=0.1"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.out, "");
  }
} // namespace end_to_end
