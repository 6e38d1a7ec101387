#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// `nsfd compare`: what differs between runs.

namespace end_to_end::test_compare
{
  namespace fs = std::filesystem;

  namespace
  {
    const std::vector<std::string> plate = {"Mesh/cells=10, 10"};

    std::vector<std::string> plate_with(const std::string &setting)
    {
      std::vector<std::string> all = plate;
      all.push_back(setting);
      return all;
    }

    /** Two runs of a plate: as it is, and with less toughness. */
    struct Runs {
      explicit Runs(const Workspace &workspace)
          : a(good_run(workspace, "a", {scene("midplane"), plate})),
            b(good_run(workspace, "b",
                       {scene("midplane"),
                        plate_with("Interface: midline/toughness=0.4 J/m^2")}))
      {
      }
      Result a, b;
    };

    std::vector<std::string> all_files(const Workspace &workspace)
    {
      return files_below(workspace.path());
    }
  } // namespace

  TEST(Compare, OfARunWithItselfIsNothing)
  {
    const Workspace workspace;
    const Result run = good_run(workspace, "a", {scene("midplane"), plate});
    const auto before = all_files(workspace);
    const Outcome outcome =
        nsfd(workspace, {"compare", "a", "a", "--tolerance", "0"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const char *text :
         {"are the same\n", "largest difference of results: 0.00e+00; within 0",
          "A  a\nB  a\n"})
      EXPECT_NE(outcome.out.find(text), std::string::npos) << outcome.out;
    EXPECT_EQ(all_files(workspace), before) << "nothing is written";
  }

  TEST(Compare, SaysWhatDiffers)
  {
    const Workspace workspace;
    const Runs runs(workspace);
    const auto before = all_files(workspace);
    const Outcome outcome = nsfd(workspace, {"compare", "a", "b"});
    EXPECT_EQ(outcome.exit_code, 0) << "differences are no error";
    for (const char *text :
         {"parameters: 1 of ",
          "Interface: midline/toughness  0.5 J/m^2  0.4 J/m^2",
          "energy/kinetic", "dissipated/damage", "certificate",
          "curves over t = ", "fragments"})
      EXPECT_NE(outcome.out.find(text), std::string::npos) << text << "\n"
                                                           << outcome.out;
    EXPECT_EQ(outcome.out.find("Output/directory"), std::string::npos);
    EXPECT_EQ(all_files(workspace), before) << "nothing is written";
  }

  // the numbers against the files themselves
  TEST(Compare, MeasuresWhatTheFilesSay)
  {
    const Workspace workspace;
    const Runs runs(workspace);
    const Outcome outcome =
        nsfd(workspace, {"compare", "a", "b", "--output", "both"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto json = nlohmann::json::parse(
        read_text(workspace.path() / "both" / "compare.json"));
    const double energy = std::max(runs.a.history.largest_energy(),
                                   runs.b.history.largest_energy());
    ASSERT_EQ(runs.a.history["time"], runs.b.history["time"]);
    for (const char *name : {"kinetic", "damage", "work"}) {
      double largest = 0.;
      for (std::size_t k = 0; k < runs.a.history.size(); ++k)
        largest = std::max(largest, std::abs(runs.b.history[name][k] -
                                             runs.a.history[name][k]));
      ASSERT_GT(largest, 0.) << name;
      const auto found = std::find_if(
          json.at("curves").begin(), json.at("curves").end(),
          [&](const auto &curve) { return curve.at("name") == name; });
      ASSERT_NE(found, json.at("curves").end());
      expect_below(
          std::string("difference of ") + name,
          std::abs(found->at("largest").get<double>() * energy / largest - 1.),
          1e-12, "the same sum");
      EXPECT_LE(found->at("mean"), found->at("largest"));
    }
    const auto number = std::find_if(
        json.at("numbers").begin(), json.at("numbers").end(),
        [](const auto &entry) { return entry.at("name") == "energy/elastic"; });
    ASSERT_NE(number, json.at("numbers").end());
    EXPECT_EQ(number->at("values")[0], runs.a.summary["energy"]["elastic"]);
    EXPECT_EQ(number->at("values")[1], runs.b.summary["energy"]["elastic"]);
    EXPECT_EQ(json.at("parameters").size(), 1u);

    const std::string html =
        read_text(workspace.path() / "both" / "compare.html");
    for (const char *text : {"</html>", "<svg", "Interface: midline/toughness"})
      EXPECT_NE(html.find(text), std::string::npos) << text;
    EXPECT_TRUE(fs::exists(workspace.path() / "both" / "curve_01.svg"));
  }

  TEST(Compare, HoldsResultsAgainstATolerance)
  {
    const Workspace workspace;
    const Runs runs(workspace);
    const Outcome beyond =
        nsfd(workspace, {"compare", "a", "b", "--tolerance", "1e-6"});
    EXPECT_EQ(beyond.exit_code, 6) << beyond.out;
    EXPECT_NE(beyond.out.find("; beyond 1e-06"), std::string::npos);
    const Outcome within =
        nsfd(workspace, {"compare", "a", "b", "--tolerance", "100"});
    EXPECT_EQ(within.exit_code, 0) << within.out;
    // another tolerance of the solver: other ways, hardly other results
    good_run(workspace, "c",
             {scene("midplane"), plate_with("Solver/tolerance=1e-11")});
    const Outcome close =
        nsfd(workspace, {"compare", "a", "c", "--tolerance", "1e-6"});
    EXPECT_EQ(close.exit_code, 0) << close.out;
  }

  TEST(Compare, TakesSeveralRuns)
  {
    const Workspace workspace;
    const Runs runs(workspace);
    const Outcome outcome =
        nsfd(workspace, {"compare", "a", "b", "a", "--output", "all"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const char *text : {"C  a", "B - A", "C - A", "kinetic, B"})
      EXPECT_NE(outcome.out.find(text), std::string::npos) << outcome.out;
    EXPECT_EQ(outcome.out.find("kinetic, C"), std::string::npos) << "the same";
  }

  TEST(Compare, TakesSummariesAlone)
  {
    const Workspace workspace;
    const Runs runs(workspace);
    fs::create_directories(workspace.path() / "kept");
    for (const Result *run : {&runs.a, &runs.b})
      fs::copy(run->directory / "summary.json",
               workspace.path() / "kept" /
                   (run->directory.filename().string() + ".json"));
    const Outcome outcome =
        nsfd(workspace, {"compare", "kept/a.json", "kept/b.json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const char *text :
         {"parameters: not beside every summary",
          "curves: not beside every summary", "energy/kinetic"})
      EXPECT_NE(outcome.out.find(text), std::string::npos) << outcome.out;
  }

  TEST(Compare, NamesWhatIsMissing)
  {
    const Workspace workspace;
    good_run(workspace, "a", {scene("stop")});
    good_run(workspace, "b", {scene("stop")});
    fs::remove(workspace.path() / "b" / "history.csv");
    fs::create_directories(workspace.path() / "empty");
    write_text(workspace.path() / "text.json", "no summary");
    const auto expect_refused = [&](const std::vector<std::string> &runs,
                                    const std::vector<std::string> &texts) {
      std::vector<std::string> arguments = {"compare"};
      arguments.insert(arguments.end(), runs.begin(), runs.end());
      arguments.insert(arguments.end(), {"--output", "none"});
      const Outcome outcome = nsfd(workspace, arguments);
      EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
      for (const std::string &text : texts)
        EXPECT_NE(outcome.err.find(text), std::string::npos) << text << "\n"
                                                             << outcome.err;
      EXPECT_FALSE(fs::exists(workspace.path() / "none"));
    };
    expect_refused({"a", "nowhere"}, {"no folder or file nowhere"});
    expect_refused({"empty", "b"},
                   {"no empty/summary.json", "no b/history.csv"});
    expect_refused({"a", "text.json"}, {"text.json is not the summary"});
    // a file is there already
    write_text(workspace.path() / "empty" / "mine", "text");
    const Outcome taken =
        nsfd(workspace, {"compare", "a", "a", "--output", "empty"});
    EXPECT_EQ(taken.exit_code, 1);
    // and it is not of a run: nothing there may be replaced
    EXPECT_EQ(
        nsfd(workspace, {"compare", "a", "a", "--output", "empty", "--force"})
            .exit_code,
        1);
    EXPECT_TRUE(fs::exists(workspace.path() / "empty" / "mine"));
  }

  TEST(Compare, RefusesWrongUsage)
  {
    const Workspace workspace;
    good_run(workspace, "a", {scene("stop")});
    const auto before = all_files(workspace);
    const std::vector<std::pair<std::vector<std::string>, std::string>> calls =
        {{{}, "two runs are needed"},
         {{"a"}, "two runs are needed"},
         {{"a", "a", "--tolerance", "-1"}, "must be 0 or more"},
         {{"a", "a", "--tolerance", "small"}, "--tolerance"},
         {{"a", "a", "--tolerence", "1"}, "`--tolerance`"},
         {{"a", "a", "--output", "a", "--force"}, "is one of the runs"},
         {{"a", "a/summary.json", "--output", "a", "--force"},
          "is one of the runs"}};
    for (const auto &[arguments, text] : calls) {
      std::vector<std::string> all = {"compare"};
      all.insert(all.end(), arguments.begin(), arguments.end());
      const Outcome outcome = nsfd(workspace, all);
      EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
      EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
    }
    EXPECT_EQ(all_files(workspace), before);
    const Outcome help = nsfd(workspace, {"compare", "--help"});
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_NE(help.out.find("Exit code"), std::string::npos);
    EXPECT_NE(nsfd(workspace, {"--help"}).out.find("nsfd compare"),
              std::string::npos);
  }
} // namespace end_to_end::test_compare
