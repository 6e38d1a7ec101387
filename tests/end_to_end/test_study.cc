#include "program.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <sstream>
#include <thread>

// `nsfd study`: folders, tables, orders, what happens when something fails.

namespace end_to_end::test_study
{
  namespace fs = std::filesystem;

  namespace
  {
    using Words = std::vector<std::string>;

    /** A study starts a process per case: longer than a scene may take. */
    Outcome patient_nsfd(const Workspace &workspace, Words arguments)
    {
      arguments.insert(arguments.begin(), NSFD_PROGRAM);
      return Process(arguments, workspace.path()).wait(250.);
    }

    /** A study of the standing mode in the folder `s` of the workspace. */
    Outcome study(const Workspace &workspace, const Words &vary,
                  const Words &more = {})
    {
      Words arguments = {
          "study", scene("mode").string(), "--output", "s",
          "--set", "Time/end=50 us",       "--set",    "Study/repeats=1"};
      for (const std::string &one : vary) {
        arguments.push_back("--vary");
        arguments.push_back(one);
      }
      arguments.insert(arguments.end(), more.begin(), more.end());
      return patient_nsfd(workspace, arguments);
    }

    nlohmann::json json_of(const Workspace &workspace)
    {
      return nlohmann::json::parse(
          read_text(workspace.path() / "s" / "study.json"));
    }

    /** Column @p name of study.csv; cells of it hold no commas. */
    std::size_t lines_of(const Workspace &workspace)
    {
      std::istringstream stream(
          read_text(workspace.path() / "s" / "study.csv"));
      std::size_t n = 0;
      for (std::string line; std::getline(stream, line);)
        ++n;
      return n;
    }

    const Words three_meshes = {"Discretization/degree=1,2",
                                "Mesh/cells=[4*2^0..2, 1] & "
                                "Time/step=0.02/2^0..2 courant"};
  } // namespace

  // The step is so short that the mesh alone decides: p + 1 for the
  // displacement over three meshes, as the mode has no front.
  TEST(Study, TwoDegreesOnThreeMeshes)
  {
    const Workspace workspace;
    const Outcome outcome =
        study(workspace, three_meshes,
              {"--set", "Study/expected orders=displacement_L2: degree + 1",
               "--set", "Study/order tolerance=0.3"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto json = json_of(workspace);
    EXPECT_EQ(json["done"], 6);
    unsigned int judged = 0;
    for (const auto &order : json["orders"])
      if (order["error"] == "displacement_L2") {
        ++judged;
        EXPECT_EQ(order["verdict"], "as expected") << order.dump(2);
        EXPECT_EQ(order["points"], 3);
      }
    EXPECT_EQ(judged, 2u);
    EXPECT_EQ(lines_of(workspace), 7u);
    EXPECT_NE(outcome.out.find("2 of 2 orders as expected"), std::string::npos)
        << outcome.out;
    EXPECT_NE(outcome.out.find("limit of this study"), std::string::npos);
    for (const char *name :
         {"study.html", "study.csv", "error_time_displacement_L2.svg",
          "error_unknowns_displacement_L2.svg", "ledger_defect.svg",
          "numerical_dissipation.svg", "degree=1_cells=4-1/summary.json",
          "degree=1_cells=4-1/parameters.prm",
          "degree=2_cells=16-1/history.csv"})
      EXPECT_TRUE(fs::exists(workspace.path() / "s" / name)) << name;
    EXPECT_FALSE(
        fs::exists(workspace.path() / "s/degree=1_cells=4-1/report.html"));
    // six checks of the best three cases: tolerance and step
    EXPECT_EQ(json["checks"].size(), 6u);
    for (const auto &check : json["checks"])
      if (check["reason"] == "tolerance/100") {
        EXPECT_NEAR(double(check["after"]) / double(check["before"]), 1., 0.1);
      }
  }

  TEST(Study, EveryFileOfStudiesCanBeRun)
  {
    const Workspace workspace;
    std::size_t n = 0;
    for (const auto &entry : fs::directory_iterator(fs::path(NSFD_SOURCE_DIR) /
                                                    "prm" / "studies")) {
      const Outcome outcome =
          nsfd(workspace, {entry.path().string(), "--check"});
      EXPECT_EQ(outcome.exit_code, 0) << entry.path() << outcome.err;
      EXPECT_NE(outcome.out.find("cases in output/"), std::string::npos)
          << entry.path() << outcome.out;
      ++n;
    }
    EXPECT_GE(n, 3u);
    const fs::path paper = fs::path(NSFD_SOURCE_DIR) / "prm" / "paper";
    for (const std::string name :
         {"figure_10_modulus", "rupture", "figure_11_rupture", "table_1"}) {
      const Outcome outcome =
          nsfd(workspace, {(paper / (name + ".prm")).string(), "--check"});
      EXPECT_EQ(outcome.exit_code, 0) << name << outcome.err;
    }
    EXPECT_EQ(files_below(workspace.path()), Words());
  }

  TEST(Study, CasesAreOrdinaryRuns)
  {
    const Workspace workspace;
    const Words no_checks = {"--set", "Study/limit checks=false"};
    ASSERT_EQ(
        study(workspace, {"Mesh/cells=[4, 1],[8, 1]"}, no_checks).exit_code, 0);
    const Result alone =
        run(workspace, "alone",
            {scene("mode"), {"Time/end=50 us", "Mesh/cells=8, 1"}});
    const auto summary = nlohmann::json::parse(
        read_text(workspace.path() / "s/cells=8-1/summary.json"));
    EXPECT_EQ(summary["errors"], alone.summary["errors"]);
    EXPECT_EQ(read_text(workspace.path() / "s/cells=8-1/history.csv"),
              alone.history_text);
  }

  TEST(Study, ResultsAreKeptOrTakenOver)
  {
    const Workspace workspace;
    const Words no_checks = {"--set", "Study/limit checks=false"};
    const auto with = [&no_checks](Words words) {
      words.insert(words.end(), no_checks.begin(), no_checks.end());
      return words;
    };
    const std::string two = "Mesh/cells=[4, 1],[8, 1]";
    ASSERT_EQ(study(workspace, {two}, no_checks).exit_code, 0);
    const fs::path first = workspace.path() / "s/cells=4-1/summary.json";
    const auto time = fs::last_write_time(first);

    // again: nothing is touched
    const Outcome again = study(workspace, {two}, no_checks);
    EXPECT_EQ(again.exit_code, 1);
    EXPECT_NE(again.err.find("--resume"), std::string::npos) << again.err;
    EXPECT_EQ(fs::last_write_time(first), time);

    // a third mesh, and one case that did not come to its end
    fs::remove(workspace.path() / "s/cells=8-1/case.json");
    const Outcome more =
        study(workspace, {"Mesh/cells=[4*2^0..2, 1]"}, with({"--resume"}));
    EXPECT_EQ(more.exit_code, 0) << more.err;
    EXPECT_EQ(fs::last_write_time(first), time);
    EXPECT_EQ(lines_of(workspace), 4u);
    std::size_t taken = 0;
    for (std::size_t at = 0;
         (at = more.out.find("taken over", at)) != std::string::npos; ++at)
      ++taken;
    EXPECT_EQ(taken, 1u) << more.out;

    // another parameter makes it another case
    const Outcome other =
        study(workspace, {two}, with({"--resume", "--set", "Time/theta=1"}));
    EXPECT_EQ(other.exit_code, 0) << other.err;
    EXPECT_EQ(other.out.find("taken over"), std::string::npos) << other.out;
    EXPECT_EQ(study(workspace, {two}, with({"--force"})).exit_code, 0);
    EXPECT_EQ(study(workspace, {two}, with({"--force", "--resume"})).exit_code,
              2);
  }

  TEST(Study, OneFailingCaseDoesNotStopTheRest)
  {
    const Workspace workspace;
    // one iteration, and no shorter step: not enough for 1e-10
    const Outcome outcome =
        study(workspace,
              {"Solver/maximum iterations=1, 200 & Time/maximum bisections=0",
               "Mesh/cells=[4, 1],[8, 1]"},
              {"--set", "Study/limit checks=false"});
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    EXPECT_NE(outcome.err.find("2 of 4 cases are not done"), std::string::npos)
        << outcome.err;
    const auto json = json_of(workspace);
    EXPECT_EQ(json["done"], 2);
    for (const auto &one : json["runs"]) {
      const bool fails = one["parameters"]["Solver/maximum iterations"] == "1";
      EXPECT_EQ(one["status"], fails ? "failed" : "done") << one["case"];
      EXPECT_EQ(one["failure"].get<std::string>().empty(), !fails);
    }
  }

  TEST(Study, BadInputOfAnyCombinationRunsNothing)
  {
    const Workspace workspace;
    const Outcome outcome =
        study(workspace, {"Time/theta=0.5, 0.2", "Discretization/degree=1, x"});
    EXPECT_EQ(outcome.exit_code, 1);
    for (const char *message : {"theta = 0.2", "degree = x", "2 errors"})
      EXPECT_NE(outcome.err.find(message), std::string::npos) << message << "\n"
                                                              << outcome.err;
    EXPECT_EQ(files_below(workspace.path()), Words());
  }

  // The same case on one rank and on two: same errors, and two of them talk.
  TEST(Study, RanksVary)
  {
    const Workspace workspace;
    const Outcome outcome = study(workspace, {"Study/ranks=1, 2"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("share of the lesser"), std::string::npos)
        << outcome.out;
    const auto json = json_of(workspace);
    ASSERT_EQ(json["done"], 2);
    const auto &one = json["runs"][0], &two = json["runs"][1];
    EXPECT_EQ(one["parameters"]["Study/ranks"], "1");
    EXPECT_EQ(one["messages_per_step"], 0.);
    EXPECT_EQ(one["collectives_per_step"], 0.);
    EXPECT_GE(two["messages_per_step"].get<double>(),
              two["operator_applications_per_step"].get<double>());
    EXPECT_GT(two["collectives_per_step"].get<double>(), 0.);
    EXPECT_EQ(one["errors"], two["errors"]);
    EXPECT_NE(
        read_text(workspace.path() / "s" / "study.html").find("<h2>Ranks"),
        std::string::npos);
  }

  TEST(Study, NumbersOfRanksAreChecked)
  {
    const Workspace workspace;
    const Outcome outcome = study(workspace, {"Study/ranks=0, 1.5"});
    EXPECT_EQ(outcome.exit_code, 1);
    for (const char *message : {"`0` is no number of ranks",
                                "`1.5` is no number of ranks", "1, 2, 4"})
      EXPECT_NE(outcome.err.find(message), std::string::npos) << message << "\n"
                                                              << outcome.err;
    EXPECT_EQ(files_below(workspace.path()), Words());
  }

  TEST(Study, StopsOnASignalAndGoesOn)
  {
    const Workspace workspace;
    const Words command = {NSFD_PROGRAM,
                           "study",
                           scene("mode").string(),
                           "--output",
                           "s",
                           "--set",
                           "Study/repeats=1",
                           "--set",
                           "Study/limit checks=false",
                           "--vary",
                           "Mesh/cells=[4, 1],[2048, 1],[8, 1]"};
    {
      Process process(command, workspace.path());
      // the second case takes minutes
      const fs::path second = workspace.path() / "s/cells=2048-1/history.csv";
      for (int i = 0; i < 600 && !fs::exists(second); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
      ASSERT_TRUE(fs::exists(second));
      process.send(SIGTERM);
      const Outcome outcome = process.wait(60.);
      EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
    }
    auto json = json_of(workspace);
    EXPECT_EQ(json["runs"][0]["status"], "done");
    EXPECT_EQ(json["runs"][1]["status"], "stopped");
    EXPECT_EQ(json["runs"][2]["status"], "not run");

    const Outcome outcome = patient_nsfd(
        workspace, {"study", scene("mode").string(), "--output", "s", "--set",
                    "Study/repeats=1", "--set", "Study/limit checks=false",
                    "--vary", "Mesh/cells=[4, 1],[8, 1]", "--resume"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("taken over"), std::string::npos);
    EXPECT_EQ(json_of(workspace)["done"], 2);
  }

  // What a study that was killed has left running holds the folder of its case.
  TEST(Study, WaitsForWhatWritesToItsFolder)
  {
    const Workspace workspace;
    const fs::path elsewhere = workspace.path() / "elsewhere"; // it prints here
    fs::create_directory(elsewhere);
    ASSERT_EQ(study(workspace, {"Mesh/cells=[4, 1],[8, 1]"}).exit_code, 0);
    const fs::path folder = workspace.path() / "s/cells=8-1";
    fs::remove(folder / "case.json");
    fs::remove(folder / "history.csv"); // the next one is that of the other
    Process other({NSFD_PROGRAM, scene("mode").string(), "--output",
                   folder.string(), "--force", "--quiet", "--set",
                   "Mesh/cells=2048, 1"},
                  elsewhere); // minutes
    ASSERT_TRUE(wait_for_rows(folder, 2));
    Process resumed({NSFD_PROGRAM, "study", scene("mode").string(), "--output",
                     "s", "--set", "Time/end=50 us", "--set", "Study/repeats=1",
                     "--vary", "Mesh/cells=[4, 1],[8, 1]", "--resume"},
                    workspace.path());
    std::this_thread::sleep_for(std::chrono::seconds(8));
    EXPECT_TRUE(resumed.is_running());
    EXPECT_TRUE(other.is_running());
    other.send(SIGKILL);
    other.wait(10.);
    const Outcome outcome = resumed.wait(60.);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("waits until that has ended"), std::string::npos)
        << outcome.err;
    EXPECT_EQ(json_of(workspace)["done"], 2);
  }

  // A file with the section is a study by itself; ranks, jobs and repeats.
  TEST(Study, SectionOfAFile)
  {
    const Workspace workspace;
    write_text(workspace.path() / "mine.prm",
               "# mine - the mode on two meshes.\ninclude " +
                   scene("mode").string() +
                   "\nsubsection Vary: mesh\n"
                   "  set Mesh/cells = [4, 1], [8, 1]\n"
                   "end\n"
                   "subsection Study\n"
                   "  set repeats      = 2\n"
                   "  set ranks        = 2\n"
                   "  set jobs         = 2\n"
                   "  set limit checks = false\n"
                   "end\n");
    const Words shorter = {"--set", "Time/end=20 us"};
    const auto call = [&](Words words) {
      words.insert(words.begin(), "mine.prm");
      words.insert(words.end(), shorter.begin(), shorter.end());
      return patient_nsfd(workspace, words);
    };
    const Outcome check = call({"--check"});
    EXPECT_EQ(check.exit_code, 0) << check.err;
    EXPECT_NE(check.out.find("2 cases in output/mine"), std::string::npos)
        << check.out;
    const Outcome print = call({"--print-parameters"});
    EXPECT_NE(print.out.find("set repeats"), std::string::npos) << print.out;
    EXPECT_EQ(files_below(workspace.path()), Words{"mine.prm"});

    const Outcome outcome = call({});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto info = nlohmann::json::parse(
        read_text(workspace.path() / "output/mine/cells=8-1/run.json"));
    EXPECT_EQ(info["ranks"], 2);
    const auto json = nlohmann::json::parse(
        read_text(workspace.path() / "output/mine/study.json"));
    for (const auto &one : json["runs"]) {
      EXPECT_GE(one["solve_seconds"].size(), 2u);
      EXPECT_EQ(one["reproducible"], true);
    }
  }
} // namespace end_to_end::test_study
