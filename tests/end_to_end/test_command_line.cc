#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <ostream>
#include <thread>

// What the shell sees: exit codes, messages, and which files appear.

namespace end_to_end::test_command_line
{
  namespace fs = std::filesystem;

  namespace
  {
    struct Call {
      std::string name;
      std::vector<std::string> arguments;
      int exit_code;
      std::string text; ///< somewhere in what is printed
    };

    const std::string stop_scene = scene("stop").string();
    const std::string paper_figure =
        (fs::path(NSFD_SOURCE_DIR) / "prm" / "paper" / "figure_03.prm")
            .string();
    const std::string fracture_scene =
        (prm_folder() / "benchmarks/fracture_everywhere.prm").string();

    const std::vector<Call> calls = {
        {"nothing", {}, 2, "nsfd FILE.prm"},
        {"unknown_option", {"--sett", "Time/end=1"}, 2, "--sett"},
        {"unknown_option_after_file", {stop_scene, "--fast"}, 2, "--fast"},
        {"study_of_nothing", {"study", stop_scene}, 1, "nothing varies"},
        {"study_without_a_file", {"study"}, 2, "no parameter file"},
        {"study_option", {"study", stop_scene, "--vray", "x"}, 2, "`--vary`"},
        {"study_of_a_missing_file", {"study", "no.prm"}, 1, "no.prm"},
        {"study_without_values",
         {"study", stop_scene, "--vary", "Time/theta"},
         2,
         "no `=`"},
        {"study_unknown_entry",
         {"study", stop_scene, "--vary", "Time/tehta=0.5,1"},
         1,
         "`theta`"},
        {"study_check",
         {"study", stop_scene, "--vary", "Time/theta=0.5,1", "--check"},
         0,
         "2 cases in output/stop"},
        {"study_help", {"study", "--help"}, 0, "--resume"},
        {"law_without_a_name", {"law"}, 2, "no law is named"},
        {"law_option", {"law", "tvergaard", "--pth", "shear"}, 2, "`--path`"},
        {"two_laws", {"law", "tvergaard", "rcc"}, 2, "one law too many"},
        {"law_set", {"law", "rcc", "--set", "friction"}, 2, "no `=`"},
        {"law_unknown", {"law", "tvergard"}, 1, "`tvergaard`"},
        {"law_of_a_missing_file", {"law", "none.prm"}, 1, "none.prm"},
        {"law_of_a_scene", {"law", stop_scene}, 1, "no section `Mesh`"},
        {"law_entry", {"law", "rcc", "--set", "stifness=1"}, 1, "`stiffness`"},
        {"law_path", {"law", "rcc", "--path", "opnening"}, 1, "`opening`"},
        {"law_path_file", {"law", "rcc", "--path", "no.csv"}, 1, "no.csv"},
        {"law_file_as_a_scene",
         {paper_figure, "--check"},
         1,
         "nsfd law FILE.prm"},
        {"law_check", {"law", "rcc", "--check"}, 0, "nothing is run"},
        {"law_help", {"law", "--help"}, 0, "shear cycle"},
        {"law_print_parameters",
         {"law", "rcc", "--print-parameters"},
         0,
         "# Adhesion energy w = G"},
        {"resume", {stop_scene, "--resume"}, 1, "there is no folder"},
        {"resume_directory",
         {"--resume=output/stop"},
         2,
         "no parameter file is named"},
        {"run", {"run", stop_scene, "--check"}, 0, "nothing is run"},
        {"run_of_nothing", {"run"}, 2, "nsfd FILE.prm"},
        {"two_files", {stop_scene, stop_scene}, 2, "one file too many"},
        {"set_without_value", {stop_scene, "--set"}, 2, "--set"},
        {"set_without_equals", {stop_scene, "--set", "Time/end"}, 2, "="},
        {"no_file", {"--check"}, 2, "no parameter file"},
        {"missing_file", {"missing.prm"}, 1, "missing.prm"},
        {"missing_file_check", {"missing.prm", "--check"}, 1, "missing.prm"},
        {"directory", {"."}, 1, "folder"},
        {"set_unknown", {stop_scene, "--set", "Time/ende=1 s"}, 1, "`ende`"},
        {"set_twice",
         {stop_scene, "--set", "Time/end=1 s", "--set", "Time/end=2 s"},
         1,
         "set twice"},
        {"check", {stop_scene, "--check"}, 0, "nothing is run"},
        // C L/E = 21, law (19), quads of degree 1: Courant number 0.123
        {"check_explicit",
         {benchmark("rigid_punch").string(), "--check"},
         0,
         "600 of 1146 are within 10 %"},
        {"check_explicit_distorted", // 4 x 1600 triangles, nodes moved
         {benchmark("fracture_extrinsic").string(), "--check", "--set",
          "Mesh/type=crossed triangles", "--set", "Mesh/distortion=0.3"},
         0,
         "without the worst 64 (1 %) it would be"},
        {"check_advice",
         {fracture_scene, "--check"},
         0,
         "(Courant number 0.123) while a point softens: this step is above"},
        {"list", {"--list"}, 0, "camacho-ortiz"},
        {"help", {"--help"}, 0, "--check"},
        {"version", {"--version"}, 0, "nsfd "},
        {"print_parameters",
         {stop_scene, "--print-parameters"},
         0,
         "set maximum bisections"},
    };

    void PrintTo(const Call &call, std::ostream *stream)
    {
      *stream << call.name;
    }

    class CommandLineTest : public testing::TestWithParam<Call>
    {
    };

    const char *const five_mistakes = R"(# five.prm - five mistakes.
set dimension = 2
subsection Mesh
  set type         = rectangle
  set lower corner = 0, 0
  set upper corner = 1 m, 0.2 m
  set cells        = 1, 1.5
end
subsection Material: block
  set model   = rigid
  set density = -1000 kg/m^3
end
subsection Interface: none
  set law = rigidd
end
subsection Obstacle: plane
  set where    = bottom
  set point    = 0, 0
  set normal   = 0, 1
  set friction = 3 m
end
subsection Time
  set end   = 0.5 s
  set step  = 2 ms
  set theta = 0.3
end
)";

    void expect_five_mistakes(const Outcome &outcome)
    {
      EXPECT_EQ(outcome.exit_code, 1);
      for (const char *message :
           {"five.prm:7: error: cells = 1.5",
            "five.prm:11: error: density = -1000 kg/m^3",
            "five.prm:14: error: law = rigidd",
            "five.prm:20: error: `3 m` is a length",
            "five.prm:25: error: theta = 0.3", "5 errors, nothing was run"})
        EXPECT_NE(outcome.err.find(message), std::string::npos)
            << message << "\n"
            << outcome.err;
    }
  } // namespace

  TEST_P(CommandLineTest, ExitsAsPromisedAndWritesNothing)
  {
    const Call &call = GetParam();
    const Workspace workspace;
    const Outcome outcome = nsfd(workspace, call.arguments);
    EXPECT_EQ(outcome.exit_code, call.exit_code) << outcome.err;
    const std::string &printed =
        call.exit_code == 0 ? outcome.out : outcome.err;
    EXPECT_NE(printed.find(call.text), std::string::npos)
        << outcome.out << outcome.err;
    EXPECT_EQ(files_below(workspace.path()), std::vector<std::string>());
  }

  INSTANTIATE_TEST_SUITE_P(Table, CommandLineTest, testing::ValuesIn(calls),
                           [](const auto &info) { return info.param.name; });

  TEST(CommandLine, AbsentPartsAreAbsentFromTheHelp)
  {
    const Workspace workspace;
    const std::string help = nsfd(workspace, {"--help"}).out;
    for (const char *word :
         {"--set", "--output", "--force", "--check", "--print-parameters",
          "--list", "--version", "--help", "--quiet", "--resume", "nsfd law",
          "nsfd solve", "nsfd study"})
      EXPECT_NE(help.find(word), std::string::npos) << word;
  }

  TEST(CommandLine, AllMistakesAtOnce)
  {
    const Workspace workspace;
    write_text(workspace.path() / "five.prm", five_mistakes);
    expect_five_mistakes(nsfd(workspace, {"five.prm"}));
    expect_five_mistakes(nsfd(workspace, {"five.prm", "--check"}));
    expect_five_mistakes(nsfd(workspace, {"five.prm", "--print-parameters"}));
    expect_five_mistakes(
        Process({NSFD_MPIRUN, "--allow-run-as-root", "--oversubscribe", "-n",
                 "2", NSFD_PROGRAM, "five.prm"},
                workspace.path())
            .wait(60.));
    EXPECT_EQ(files_below(workspace.path()),
              std::vector<std::string>{"five.prm"});
  }

  // A scene that its exact solution does not know is bad input, too.
  TEST(CommandLine, WrongSceneForItsVerificationCase)
  {
    const Workspace workspace;
    const Outcome outcome =
        nsfd(workspace, {scene("incline").string(), "--set",
                         "Material: block/initial velocity x=1 m/s"});
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_NE(outcome.err.find("the block must start from rest"),
              std::string::npos)
        << outcome.err;
    EXPECT_EQ(files_below(workspace.path()), std::vector<std::string>());
  }

  TEST(CommandLine, OlderResultsAreNotOverwritten)
  {
    const Workspace workspace;
    const auto again = [&](const std::vector<std::string> &more) {
      std::vector<std::string> arguments = {stop_scene, "--quiet"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      return nsfd(workspace, arguments);
    };
    const fs::path directory = workspace.path() / "output" / "stop";
    ASSERT_EQ(again({}).exit_code, 0) << "the default directory";
    ASSERT_TRUE(fs::exists(directory / "history.csv"));
    write_text(directory / "notes.txt", "mine");
    std::map<std::string, std::string> before;
    for (const std::string &name : files_below(directory))
      before[name] = read_text(directory / name);

    const Outcome refused = again({"--set", "Time/end=0.4 s"});
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
    EXPECT_EQ(files_below(directory).size(), before.size());
    for (const auto &[name, text] : before)
      EXPECT_TRUE(read_text(directory / name) == text) << name;

    const Outcome forced = again({"--force", "--set", "Time/end=0.4 s"});
    EXPECT_EQ(forced.exit_code, 0) << forced.err;
    EXPECT_LT(read_text(directory / "history.csv").size(),
              before["history.csv"].size());
    EXPECT_EQ(read_text(directory / "notes.txt"), "mine")
        << "what no run has written stays";
  }

  // As root, in a container, without any setting for MPI.
  TEST(CommandLine, RunsInABareEnvironment)
  {
    const Workspace workspace;
    const Outcome outcome =
        nsfd(workspace, {stop_scene, "--quiet"}, Environment::bare);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "") << "--quiet prints errors only";
    EXPECT_EQ(outcome.err, "");
  }

  namespace
  {
    void expect_stopped_by(const int signal)
    {
      const Workspace workspace;
      const fs::path directory = workspace.path() / "stopped";
      Process process({NSFD_PROGRAM, scene("midplane").string(), "--quiet",
                       "--output", directory.string(), "--set",
                       "Mesh/cells=10, 10", "--set", "Time/step=1e-3 courant",
                       "--set", "Output/fields every=0"},
                      workspace.path());
      const auto n_steps = [&] {
        const std::string text = read_text(directory / "history.csv");
        return std::count(text.begin(), text.end(), '\n') - 2; // header, start
      };
      for (unsigned int i = 0; i < 3000 && n_steps() < 5; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      ASSERT_TRUE(process.is_running());
      process.send(signal);
      const Outcome outcome = process.wait(30.);
      EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
      const auto summary = nlohmann::json::parse(
          read_text(directory / "summary.json"), nullptr, false);
      ASSERT_TRUE(summary.is_object());
      EXPECT_FALSE(summary["completed"].get<bool>());
      EXPECT_NE(summary["failure"].get<std::string>().find("stopped"),
                std::string::npos);
      EXPECT_GE(summary["steps"].get<int>(), 5);
      EXPECT_EQ(summary["steps"].get<int>(), n_steps());
      EXPECT_LE(summary["ledger_defect_max"].get<double>(), 1e-9);
      EXPECT_TRUE(fs::exists(directory / "report.html"));
      EXPECT_EQ(snapshots(directory, "fields").size(), 2u)
          << "the start and where it stopped";
    }
  } // namespace

  TEST(CommandLine, StopsOnInterrupt) { expect_stopped_by(SIGINT); }
  TEST(CommandLine, StopsOnTermination) { expect_stopped_by(SIGTERM); }

  namespace
  {
    const std::vector<std::string> small_plate = {
        "Mesh/cells=12, 9", "Time/step=0.4 us", "Constants/turn=60 us",
        "Constants/pull=4 m/s", "Time/end=120 us"};
  }

  // parameters.prm is a complete scene: running it repeats the run.
  TEST(CommandLine, EchoReproducesTheRun)
  {
    const Workspace workspace;
    const std::vector<Launch> launches = {
        {torn_plate(), small_plate},
        {scene("midplane"), {"Mesh/cells=10, 10", "Solver/tolerance=1e-9"}},
        {scene("incline"), {"Constants/angle=pi / 5"}},
        {scene("mode"), {"Time/end=50 us"}},
        {scene("rigid_motion"), {"Mesh/seed=7"}}};
    for (const Launch &launch : launches) {
      const std::string name = launch.file.stem().string();
      const Result original = good_run(workspace, name, launch);
      ASSERT_TRUE(original.completed());
      // not in the directory it names
      const Result again = good_run(workspace, name + " again",
                                    {original.directory / "parameters.prm"});
      ASSERT_TRUE(again.completed());
      EXPECT_TRUE(original.history_text == again.history_text) << name;
      EXPECT_EQ(original.summary["errors"], again.summary["errors"]) << name;
    }
  }

  // A file that the scene names is found from anywhere.
  TEST(CommandLine, EchoFindsTheCurve)
  {
    const Workspace workspace;
    const fs::path folder = workspace.path() / "scenes";
    fs::create_directories(folder / "curves");
    write_text(folder / "curves" / "falling.csv", "0, 300 MPa\n3 nm, 0\n");
    write_text(folder / "steep.csv", "0, 300 MPa\n2 nm, 0\n");
    std::string text = read_text(scene("midplane"));
    for (const char *entry : {"strength ", "toughness"}) {
      const std::size_t begin = text.find("  set " + std::string(entry));
      text.erase(begin, text.find('\n', begin) + 1 - begin);
    }
    const std::string law = "camacho-ortiz";
    text.replace(text.find(law), law.size(),
                 "tabulated\n  set curve = curves/falling.csv");
    text.erase(text.find("subsection Verification"));
    write_text(folder / "pull.prm", text);

    const auto echo = [](const Result &result) {
      return entry(result.directory / "parameters.prm", "curve");
    };
    const Launch launch{folder / "pull.prm", {"Mesh/cells=4, 4"}};
    const Result original = good_run(workspace, "original", launch);
    ASSERT_TRUE(original.completed());
    EXPECT_EQ(echo(original), (folder / "curves" / "falling.csv").string());
    const Result again =
        good_run(workspace, "again", {original.directory / "parameters.prm"});
    ASSERT_TRUE(again.completed());
    EXPECT_TRUE(original.history_text == again.history_text);
    EXPECT_EQ(echo(again), echo(original));

    // from the command line: where the program runs
    Launch other = launch;
    other.set.push_back("Interface: midline/curve=scenes/steep.csv");
    const Result steep = good_run(workspace, "steep", other);
    ASSERT_TRUE(steep.completed());
    EXPECT_EQ(echo(steep), (folder / "steep.csv").string());
  }

  TEST(CommandLine, RunsAreRepeatable)
  {
    const Workspace workspace;
    const Launch launch{torn_plate(), small_plate};
    const Result first = good_run(workspace, "first", launch),
                 second = good_run(workspace, "second", launch);
    ASSERT_TRUE(first.completed() && second.completed());
    EXPECT_TRUE(first.history_text == second.history_text);
  }

  namespace
  {
    struct NotFinite {
      std::string name, scene, assignment, blamed;
    };

    const std::vector<NotFinite> not_finite = {
        {"velocity_at_the_end", "midplane",
         "Boundary: left/velocity x=1 m/s / (t / 1 ns - 10)", "Boundary: left"},
        {"velocity_at_the_start", "midplane",
         "Boundary: right/velocity x=1 m/s * log(t / 1 ns)", "Boundary: right"},
        {"velocity_at_a_place", "midplane",
         "Boundary: left/velocity x=1 m/s * sqrt(y / 1 um - 5)",
         "Boundary: left"},
        {"initial_velocity", "stop",
         "Material: block/initial velocity x=1 m/s * sqrt(-x / 1 m)",
         "Material: block/initial velocity x"},
        {"body_force", "bar_wall",
         "Material: bar/body force x=1 N/m^3 / (t / 1 s)",
         "Material: bar/body force x"},
        {"traction_at_the_start", "interface_step",
         "Boundary: left/traction x=-1 Pa / (t / 1 us)",
         "scene.prm:35: error: Boundary: left/traction x"},
        {"traction_at_the_end", "interface_step",
         "Boundary: left/traction x=-1 Pa / if(t > 179 us, 0, 1)",
         "Boundary: left/traction x"},
        {"pressure_at_the_end", "bimodular",
         "Boundary: left/pressure=1 Pa * log(420 - t / 1 us)",
         "Boundary: left/pressure"},
    };

    void PrintTo(const NotFinite &row, std::ostream *stream)
    {
      *stream << row.name;
    }

    /** The scene alone: exact solutions have wishes of their own. */
    std::string without_verification(std::string text)
    {
      const std::size_t begin = text.find("subsection Verification");
      return text.erase(begin, text.find("\nend", begin) + 5 - begin);
    }

    class CheckTest : public testing::TestWithParam<NotFinite>
    {
    };
  } // namespace

  TEST_P(CheckTest, FindsWhatIsNotFinite)
  {
    const NotFinite &row = GetParam();
    const Workspace workspace;
    write_text(workspace.path() / "scene.prm",
               without_verification(read_text(scene(row.scene))));
    const Outcome good = nsfd(workspace, {"scene.prm", "--check"});
    EXPECT_EQ(good.exit_code, 0) << good.err;
    const Outcome bad =
        nsfd(workspace, {"scene.prm", "--check", "--set", row.assignment});
    EXPECT_EQ(bad.exit_code, 1) << bad.out;
    EXPECT_NE(bad.err.find(row.blamed), std::string::npos) << bad.err;
    EXPECT_EQ(files_below(workspace.path()),
              std::vector<std::string>{"scene.prm"});
  }

  INSTANTIATE_TEST_SUITE_P(Table, CheckTest, testing::ValuesIn(not_finite),
                           [](const auto &info) { return info.param.name; });
} // namespace end_to_end::test_command_line
