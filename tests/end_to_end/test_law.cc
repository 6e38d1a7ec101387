#include "compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

// `nsfd law`: the files it writes, and when it refuses.

namespace end_to_end::test_law
{
  namespace fs = std::filesystem;

  namespace
  {
    const std::vector<std::string> all_files = {"curve.csv", "energies.svg",
                                                "law.svg",   "parameters.prm",
                                                "run.json",  "summary.json"};

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
        if (entry.path().stem().string().find("figure_0") == 0)
          files.push_back(entry.path()); // of one point; the others are scenes
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
      ASSERT_GE(rows.size(), 400u); // more where the law has kinks
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

  // Section 3.1 of the paper: static, with viscosity, with a mass.
  TEST(Law, BarOfThePaper)
  {
    const Workspace workspace;
    const fs::path prm = fs::path(NSFD_SOURCE_DIR) / "prm" / "paper";
    const auto run = [&](const std::string &name) {
      const Outcome outcome =
          nsfd(workspace, {"law", (prm / (name + ".prm")).string()});
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      EXPECT_EQ(outcome.err, "");
      return summary_of(workspace.path() / "output" / name)["curves"][0];
    };
    const auto files = [&](const std::string &name) {
      return files_below(workspace.path() / "output" / name);
    };
    using Files = std::vector<std::string>;
    // u_a = 2/sqrt(1-k) - 1 for k = 1/4, and the area under the law beyond it
    const double u = 2. / std::sqrt(0.75) - 1., T = u * (3. - u) / (1. + u);
    const auto area = [](const double x) {
      return 4. * x - 0.5 * x * x - 4. * std::log(1. + x);
    };
    const double excess = 2. * T * T - (area(3.) - area(u));

    const auto still = run("figure_06_static");
    EXPECT_EQ(files("figure_06_static"),
              (Files{"bar.svg", "curve.csv", "energies.svg", "grip.svg",
                     "parameters.prm", "run.json", "summary.json"}));
    ASSERT_EQ(still["jumps"].size(), 1u);
    EXPECT_NEAR(still["jumps"][0]["grip"].get<double>(), u + 4. * T, 1e-13);
    EXPECT_NEAR(still["left_over"].get<double>(), excess, 1e-12);
    EXPECT_NEAR(still["slope_ratio"].get<double>(), 3., 1e-14);

    // what viscosity takes is the same whatever it is
    const auto held = run("figure_08");
    EXPECT_EQ(
        files("figure_08"),
        (Files{"bar.svg", "curve.csv", "energies.svg", "floor.svg",
               "parameters.prm", "run.json", "speeds.svg", "summary.json"}));
    EXPECT_NEAR(held["viscous"].get<double>(), excess, 2e-9);
    const auto pulled = run("figure_06_viscous");
    EXPECT_GT(pulled["viscous"].get<double>(), excess);
    EXPECT_NEAR(pulled["numerical"].get<double>(), 0., 1e-10);

    const auto swings = run("figure_06_dynamic");
    EXPECT_EQ(
        files("figure_06_dynamic"),
        (Files{"bar.svg", "curve.csv", "energies.svg", "grip.svg",
               "parameters.prm", "run.json", "slopes.svg", "summary.json"}));
    // M/(S theta h^2) + theta k = 3/8 of the exact rule, theta = 1/2
    EXPECT_NEAR(swings["unique_step"].get<double>(), std::sqrt(8.), 1e-12);
    EXPECT_EQ(swings["ambiguous_steps"], 0);
    EXPECT_GT(swings["kinetic"].get<double>() + swings["bar"].get<double>(),
              excess);
    EXPECT_NEAR(run("figure_09")["unique_step"].get<double>(), std::sqrt(2.),
                1e-12);
  }

  // (42): max |T'| in units of R_max^2 / G decides which bars are too soft.
  TEST(Law, SlopesDecideWhichBarsJump)
  {
    const Workspace workspace;
    const std::string strength = "strength=2 MPa", G = "toughness=4 J/m^2";
    struct Row {
      std::string law, more;
      double slope; ///< in R_max^2 / G = 1e12 Pa/m
    };
    const Row rows[] = {
        {"camacho-ortiz", "", 0.5},
        {"geubelle-baylor", "initial strength parameter=0.8", 0.625},
        {"tvergaard", "", 1.265625},
        {"michel-suquet", "", 0.75 * (4.5 - 4. * std::log(2.))},
        {"trapezoid", "l1=0.15;l2=0.5", 1.35},
        {"rcc", "stiffness=1e12;adhesion energy=4", 3.}};
    unsigned int number = 0;
    for (const Row &row : rows)
      for (const double share : {0.999, 1.001}) {
        const std::string output = "bar" + std::to_string(++number);
        std::vector<std::string> command = {"law", row.law, "--output", output};
        const auto set = [&](const std::string &entry) {
          command.insert(command.end(), {"--set", entry});
        };
        if (row.law != "rcc") {
          set(strength);
          set(G);
        }
        std::istringstream more(row.more);
        for (std::string entry; std::getline(more, entry, ';');)
          set(entry);
        std::ostringstream stiffness;
        stiffness.precision(17);
        stiffness << "Bar/stiffness=" << share * row.slope * 1e12;
        set(stiffness.str());
        const Outcome outcome = nsfd(workspace, command);
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        const auto curve = summary_of(workspace.path() / output)["curves"][0];
        const bool is_soft = share < 1.;
        EXPECT_NEAR(curve["slope_ratio"].get<double>(), 1. / share, 1e-12)
            << row.law;
        EXPECT_EQ(curve["jumps"].size(), is_soft ? 1u : 0u) << row.law;
        EXPECT_NE(outcome.out.find(is_soft ? "1.001 k: the equilibrium jumps"
                                           : "0.999 k: one equilibrium"),
                  std::string::npos)
            << outcome.out;
      }
    for (const std::string law : {"brittle", "dugdale"}) {
      const Outcome outcome =
          nsfd(workspace, {"law", law, "--set", "Bar/stiffness=1e20"});
      EXPECT_NE(outcome.out.find("every bar jumps"), std::string::npos)
          << outcome.out;
    }
  }

  // A step beyond the bound runs, with a warning that says what to write.
  TEST(Law, BarWarnsOfLongSteps)
  {
    const Workspace workspace;
    const std::string file =
        (fs::path(NSFD_SOURCE_DIR) / "prm" / "paper" / "figure_06_dynamic.prm")
            .string();
    const Outcome outcome =
        nsfd(workspace, {"law", file, "--set", "Bar/step=8 s"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("several solutions"), std::string::npos)
        << outcome.err;
    EXPECT_NE(outcome.err.find("set step = 2.69 s"), std::string::npos)
        << outcome.err;
    EXPECT_NE(outcome.out.find("of steps below 2.828 s"), std::string::npos)
        << outcome.out;
    const auto curve = summary_of(workspace.path() / "output" /
                                  "figure_06_dynamic")["curves"][0];
    EXPECT_GT(curve["ambiguous_steps"].get<int>(), 0);
  }

  TEST(Law, EchoReproducesTheBar)
  {
    const Workspace workspace;
    ASSERT_EQ(nsfd(workspace, {"law", "tvergaard", "--set", "Bar/mode=viscous",
                               "--set", "Bar/stiffness=500 GPa/m", "--set",
                               "Bar/viscosity=10 MPa*s/m", "--set",
                               "Bar/compared speeds=10 mm/s, 50 mm/s",
                               "--output", "first"})
                  .exit_code,
              0);
    const Outcome outcome =
        nsfd(workspace, {"law", "first/parameters.prm", "--output", "second"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const char *file :
         {"curve.csv", "bar.svg", "energies.svg", "floor.svg", "speeds.svg"})
      EXPECT_TRUE(read_text(workspace.path() / "first" / file) ==
                  read_text(workspace.path() / "second" / file))
          << file;
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
} // namespace end_to_end::test_law
