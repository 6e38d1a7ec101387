#include "compare.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

// Signals that ask a run to end, at moments when no step is about to.

namespace end_to_end::test_stop
{
  namespace fs = std::filesystem;

  namespace
  {
    const Launch good = {scene("midplane"),
                         {"Mesh/cells=6, 6", "Time/end=1 ns"}};
    // sweeps that come to nothing, for hours
    const Launch endless =
        with(good, {"Solver/method=gauss seidel", "Solver/tolerance=1e-30",
                    "Solver/maximum iterations=1000000000"});

    /// 2 s on a machine that has nothing else to do
    constexpr double most_seconds = 10.;

    using Clock = std::chrono::steady_clock;

    double seconds_since(const Clock::time_point start)
    {
      return std::chrono::duration<double>(Clock::now() - start).count();
    }

    /** What follows `go on with:`, for a shell. */
    std::string line_to_paste(const std::string &text)
    {
      const std::string mark = "go on with: ";
      const auto begin = text.find(mark);
      if (begin == std::string::npos)
        return "";
      return text.substr(begin + mark.size(),
                         text.find('\n', begin) - begin - mark.size());
    }
  } // namespace

  // In the first step: the state that is stored is that of t = 0.
  TEST(Stop, WithinTheFirstStep)
  {
    const Workspace workspace;
    const Result whole = good_run(workspace, "whole", good);
    const std::vector<int> signals = {SIGHUP,  SIGINT,  SIGQUIT,
                                      SIGTERM, SIGUSR1, SIGXCPU};
    for (const int signal : signals) {
      SCOPED_TRACE(strsignal(signal));
      const fs::path directory =
          workspace.path() / ("signal " + std::to_string(signal));
      Process process(command_of(endless, directory, {}), workspace.path());
      ASSERT_TRUE(wait_for_rows(directory, 1)) << "that of t = 0";
      process.send(signal);
      const auto start = Clock::now();
      const Outcome outcome = process.wait(30.);
      EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
      EXPECT_LT(seconds_since(start), most_seconds);
      EXPECT_TRUE(fs::exists(newest(directory)));
      EXPECT_NE(outcome.err.find("within the next one"), std::string::npos)
          << outcome.err;
      if (signal != SIGINT)
        continue;
      // the step can be taken now, from the same state
      const Result after =
          resume(workspace, directory.filename().string(), good);
      ASSERT_TRUE(after.completed()) << after.description();
      EXPECT_EQ(after.history_text, whole.history_text);
    }
  }

  // Nobody reads what the run says, and it has nothing to say for long.
  TEST(Stop, ClosedPipe)
  {
    const Workspace workspace;
    std::string command;
    for (const std::string &word :
         command_of(endless, workspace.path() / "run", {}))
      if (word != "--quiet")
        command += "'" + word + "' ";
    Process process(
        {"sh", "-c",
         "{ " + command + " 2> said; echo $? > code; } | head -n 1"},
        workspace.path());
    const Outcome outcome = process.wait(60.);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(read_text(workspace.path() / "code"), "4\n");
    const std::string said = read_text(workspace.path() / "said");
    EXPECT_NE(said.find("closed standard output"), std::string::npos) << said;
    EXPECT_TRUE(fs::exists(newest(workspace.path() / "run")));
  }

  // All ranks leave the same iteration, whoever gets the signal.
  TEST(Stop, OnTwoRanks)
  {
    const Workspace workspace;
    const fs::path directory = workspace.path() / "run";
    Launch two = endless;
    two.ranks = 2;
    Process process(command_of(two, directory, {}), workspace.path());
    ASSERT_TRUE(wait_for_rows(directory, 1));
    process.send(SIGUSR1); // which mpirun hands on
    const Outcome outcome = process.wait(30.);
    EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
    EXPECT_TRUE(fs::exists(newest(directory)));
    EXPECT_EQ(line_to_paste(outcome.err).compare(0, 12, "mpirun -n 2 "), 0)
        << outcome.err;
  }

  TEST(Stop, LineToPasteGoesOn)
  {
    const Workspace workspace;
    const fs::path directory = workspace.path() / "a run";
    const Launch launch = with(good, {"Time/step=1e-3 courant"});
    Process process(command_of(launch, directory, {"--force"}),
                    workspace.path());
    ASSERT_TRUE(wait_for_rows(directory, 5));
    process.send(SIGTERM);
    const Outcome outcome = process.wait(30.);
    EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
    const std::string line = line_to_paste(outcome.err);
    EXPECT_EQ(line.find("--force"), std::string::npos) << line;
    // longer steps, or it would take its time
    std::string faster = line;
    ASSERT_NE(faster.find("1e-3"), std::string::npos) << line;
    faster.replace(faster.find("1e-3"), 4, "0.6");
    const Outcome after =
        Process({"sh", "-c", faster}, workspace.path()).wait(60.);
    EXPECT_EQ(after.exit_code, 0) << line << "\n" << after.err;
  }

  TEST(Stop, DuringSetUp)
  {
    const Workspace workspace;
    const fs::path directory = workspace.path() / "run";
    Process process(
        command_of(with(good, {"Mesh/cells=400, 400"}), directory, {}),
        workspace.path());
    std::this_thread::sleep_for(std::chrono::seconds(1));
    ASSERT_FALSE(fs::exists(directory / "history.csv"));
    process.send(SIGTERM);
    const Outcome outcome = process.wait(30.);
    EXPECT_EQ(outcome.exit_code, 4);
    EXPECT_NE(outcome.err.find("nothing had been computed that could"),
              std::string::npos)
        << outcome.err;
  }

  // A folder where the checkpoint should be.
  TEST(Stop, SaysThatNothingCouldBeStored)
  {
    const Workspace workspace;
    const fs::path directory = workspace.path() / "run";
    Process process(command_of(endless, directory, {}), workspace.path());
    ASSERT_TRUE(wait_for_rows(directory, 1));
    fs::create_directories(newest(directory) / "mine");
    process.send(SIGINT);
    const Outcome outcome = process.wait(30.);
    EXPECT_EQ(outcome.exit_code, 4);
    for (const char *words :
         {"it is a folder", "there is none before it", "could not be stored"})
      EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    EXPECT_TRUE(fs::is_directory(newest(directory) / "mine"));
  }
} // namespace end_to_end::test_stop
