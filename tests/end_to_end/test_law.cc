#include "compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

// `nsfd law`: the files it writes, and when it refuses.

namespace end_to_end
{
  namespace fs = std::filesystem;

  namespace
  {
    const std::vector<std::string> all_files = {"curve.csv", "energies.svg",
                                                "law.svg", "parameters.prm",
                                                "summary.json"};

    nlohmann::json summary_of(const fs::path &directory)
    {
      return nlohmann::json::parse(read_text(directory / "summary.json"),
                                   nullptr, false);
    }

    /** The cohesive laws of `nsfd --list`. */
    std::vector<std::string> listed_laws(const Workspace &workspace)
    {
      std::istringstream lines(nsfd(workspace, {"--list"}).out);
      std::vector<std::string> laws;
      std::string kind;
      for (std::string line; std::getline(lines, line);) {
        if (!line.empty() && line[0] != ' ')
          kind = line;
        else if (kind == "cohesive law" && line.size() > 2 && line[2] != ' ')
          laws.push_back(line.substr(2, line.find(' ', 2) - 2));
      }
      return laws;
    }

    std::vector<fs::path> paper_files()
    {
      std::vector<fs::path> files;
      for (const auto &entry :
           fs::directory_iterator(fs::path(NSFD_SOURCE_DIR) / "prm" / "paper"))
        if (entry.path().extension() == ".prm")
          files.push_back(entry.path());
      return files;
    }
  } // namespace

  TEST(Law, EveryListedLawWorksAtOnce)
  {
    const Workspace workspace;
    const std::vector<std::string> laws = listed_laws(workspace);
    EXPECT_GE(laws.size(), 4u);
    for (const std::string &law : laws) {
      const Outcome outcome = nsfd(workspace, {"law", law});
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      EXPECT_EQ(outcome.err, "");
      EXPECT_NE(outcome.out.find("(example)"), std::string::npos)
          << "it says with which parameters\n"
          << outcome.out;
      const fs::path directory = workspace.path() / "output" / ("law_" + law);
      EXPECT_EQ(files_below(directory), all_files);
      const auto summary = summary_of(directory);
      ASSERT_TRUE(summary.is_object() && summary["completed"]) << law;
      const auto &curve = summary["curves"][0];
      const double G = curve["toughness"];
      if (curve["final_opening"].is_number())
        EXPECT_NEAR(curve["damage"].get<double>(), G, 1e-10 * G) << law;
      else
        EXPECT_GT(curve["damage"].get<double>(), 0.95 * G) << law;
      const History rows(read_text(directory / "curve.csv"));
      ASSERT_GT(rows.size(), 400u);
      EXPECT_EQ(rows["damage"].back(), curve["damage"].get<double>());
      EXPECT_EQ(rows["beta"].front(), 1.);
    }
  }

  TEST(Law, NothingIsOverwrittenWithoutForce)
  {
    const Workspace workspace;
    const fs::path directory = workspace.path() / "output" / "law_tvergaard";
    ASSERT_EQ(nsfd(workspace, {"law", "tvergaard"}).exit_code, 0);
    const std::string before = read_text(directory / "curve.csv");
    const std::vector<std::string> other = {"law", "tvergaard", "--set",
                                            "strength=5 MPa"};
    const Outcome refused = nsfd(workspace, other);
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
    EXPECT_TRUE(read_text(directory / "curve.csv") == before);

    std::vector<std::string> forced = other;
    forced.insert(forced.end(), {"--force", "--quiet"});
    const Outcome outcome = nsfd(workspace, forced);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_FALSE(read_text(directory / "curve.csv") == before);

    std::vector<std::string> elsewhere = other;
    elsewhere.insert(elsewhere.end(), {"--output", "mine"});
    EXPECT_EQ(nsfd(workspace, elsewhere).exit_code, 0);
    EXPECT_EQ(files_below(workspace.path() / "mine"), all_files);
  }

  TEST(Law, EchoReproducesTheCurve)
  {
    const Workspace workspace;
    ASSERT_EQ(nsfd(workspace, {"law", "michel-suquet", "--path", "shear cycle",
                               "--reaction", "1 GPa", "--steps", "100", "--set",
                               "friction=0.3", "--output", "first"})
                  .exit_code,
              0);
    const Outcome outcome =
        nsfd(workspace, {"law", "first/parameters.prm", "--output", "second"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const char *file : {"curve.csv", "law.svg", "energies.svg"})
      EXPECT_TRUE(read_text(workspace.path() / "first" / file) ==
                  read_text(workspace.path() / "second" / file))
          << file;
  }

  TEST(Law, PathFromAFile)
  {
    const Workspace workspace;
    write_text(workspace.path() / "way.csv",
               "slip, reaction\n0, 1e6\n5e-7, 1e6\n\n-5e-7,2e6\n");
    const Outcome outcome =
        nsfd(workspace, {"law", "tvergaard", "--path", "way.csv", "--steps",
                         "0", "--set", "friction=0.5", "--set",
                         "friction exponent=0", "--output", "way"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const History rows(read_text(workspace.path() / "way" / "curve.csv"));
    EXPECT_EQ(rows["slip"], (std::vector<double>{0., 0., 5e-7, 5e-7, -5e-7}))
        << "two rows where friction turns";
    EXPECT_EQ(rows["friction"],
              (std::vector<double>{0., 0.5e6, 0.5e6, -0.5e6, -1e6}));

    write_text(workspace.path() / "way.csv", "slip,pressure\n0,1\n1,2\n");
    const Outcome wrong =
        nsfd(workspace, {"law", "tvergaard", "--path", "way.csv"});
    EXPECT_EQ(wrong.exit_code, 1);
    EXPECT_NE(wrong.err.find("`pressure`"), std::string::npos) << wrong.err;
  }

  TEST(Law, FiguresOfThePaper)
  {
    const Workspace workspace;
    EXPECT_GE(paper_files().size(), 4u);
    for (const fs::path &file : paper_files()) {
      const Outcome outcome = nsfd(workspace, {"law", file.string()});
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      const fs::path directory = workspace.path() / "output" / file.stem();
      const auto summary = summary_of(directory);
      ASSERT_TRUE(summary.is_object() && summary["completed"]) << file;
      for (const auto &curve : summary["curves"]) {
        const double G = curve["toughness"];
        EXPECT_NEAR(curve["damage"].get<double>(), G, 1e-10 * G) << file;
        EXPECT_TRUE(fs::exists(directory / curve["file"].get<std::string>()));
      }
    }
  }

  // One process is enough: several do not get in each other's way.
  TEST(Law, SeveralRanks)
  {
    const Workspace workspace;
    const auto run = [&](const std::string &law) {
      return Process({NSFD_MPIRUN, "--allow-run-as-root", "--oversubscribe",
                      "-n", "2", NSFD_PROGRAM, "law", law},
                     workspace.path())
          .wait(60.);
    };
    EXPECT_EQ(run("tvergaard").exit_code, 0);
    EXPECT_EQ(files_below(workspace.path() / "output" / "law_tvergaard"),
              all_files);
    EXPECT_EQ(run("tvergard").exit_code, 1);
  }
} // namespace end_to_end
