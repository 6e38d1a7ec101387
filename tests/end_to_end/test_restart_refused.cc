#include "disk.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <map>

// Checkpoints that cannot be read or written: what is said, and that nothing
// is lost.

namespace end_to_end::test_restart_refused
{
  namespace fs = std::filesystem;

  namespace
  {
    const Launch small = {scene("midplane"),
                          {"Mesh/cells=6, 6", "Time/end=4 ns"}};
    constexpr unsigned int every = 8;

    /** All files of a run by name. */
    std::map<std::string, std::string> contents(const fs::path &directory)
    {
      std::map<std::string, std::string> all;
      for (const std::string &name : files_below(directory))
        if (fs::is_regular_file(directory / name))
          all[name] = read_text(directory / name);
      return all;
    }

    class RestartRefused : public testing::Test
    {
    protected:
      void SetUp() override
      {
        stored_ = run(workspace_, "run", storing(small, every));
        ASSERT_TRUE(stored_.completed()) << stored_.description();
        ASSERT_TRUE(fs::exists(newest(stored_.directory)));
        ASSERT_TRUE(fs::exists(previous(stored_.directory)));
      }

      /** Resuming ends with exit code 1 and @p text, and touches nothing. */
      void expect_refused(const std::string &text,
                          const std::vector<std::string> &set = {})
      {
        const auto before = contents(stored_.directory);
        const Result result =
            resume(workspace_, "run", with(storing(small, every), set));
        EXPECT_EQ(result.outcome.exit_code, 1);
        EXPECT_NE(result.outcome.err.find(text), std::string::npos)
            << result.outcome.err;
        EXPECT_TRUE(before == contents(stored_.directory));
      }

      void overwrite(const fs::path &file, const std::string &text)
      {
        write_text(file, text);
      }

      const Workspace workspace_;
      Result stored_;
    };
  } // namespace

  TEST_F(RestartRefused, TruncatedForeignDamagedAndNewerFiles)
  {
    const std::string good = read_text(newest(stored_.directory));
    fs::remove(previous(stored_.directory));
    overwrite(newest(stored_.directory), good.substr(0, good.size() / 2));
    expect_refused("cut short");
    overwrite(newest(stored_.directory), good.substr(0, 100));
    expect_refused("cut short");
    overwrite(newest(stored_.directory), "");
    expect_refused("empty");
    overwrite(newest(stored_.directory), "\x89HDF\r\n\x1a\n something else");
    expect_refused("no checkpoint of nsfd");
    std::string damaged = good;
    damaged[good.size() / 2] = char(damaged[good.size() / 2] ^ 1);
    overwrite(newest(stored_.directory), damaged);
    expect_refused("checksum");
    std::string newer = good;
    newer.replace(newer.find("\nformat ") + 8, 1, "10");
    overwrite(newest(stored_.directory), newer);
    expect_refused("in format 10");
    fs::remove(newest(stored_.directory));
    expect_refused("no whole checkpoint");
    fs::remove_all(stored_.directory);
    const Result none = resume(workspace_, "run", small);
    EXPECT_EQ(none.outcome.exit_code, 1);
    EXPECT_FALSE(fs::exists(stored_.directory));
  }

  // Then the one before it serves.
  TEST_F(RestartRefused, FallsBackToTheOneBefore)
  {
    const std::string history = read_text(stored_.directory / "history.csv");
    const std::string good = read_text(newest(stored_.directory));
    overwrite(newest(stored_.directory), good.substr(0, good.size() - 1));
    const Result result = resume(workspace_, "run", storing(small, every));
    EXPECT_TRUE(result.completed()) << result.description();
    EXPECT_NE(result.outcome.err.find("cut short"), std::string::npos);
    EXPECT_EQ(history, result.history_text);
  }

  TEST_F(RestartRefused, ChangedParameters)
  {
    expect_refused("Material: bulk/Young modulus: 135 GPa, now 136 GPa",
                   {"Material: bulk/Young modulus=136 GPa"});
    expect_refused("Mesh/cells: 6, 6, now 7, 6", {"Mesh/cells=7, 6"});
    expect_refused("Time/theta: 0.5, now 0.6", {"Time/theta=0.6"});
    expect_refused("is not after t", {"Time/end=2 ns"});
  }

  // The end, the step, the solver and the files are free.
  TEST_F(RestartRefused, GoesOnWithOthersThatMayChange)
  {
    const std::string history = read_text(stored_.directory / "history.csv");
    const Result result =
        resume(workspace_, "run",
               with(small, {"Time/end=6 ns", "Time/step=0.3 courant",
                            "Solver/path=assembled", "Solver/tolerance=1e-9"}));
    ASSERT_TRUE(result.completed()) << result.description();
    EXPECT_NE(result.outcome.err.find("Time/end: 4 ns, now 6 ns"),
              std::string::npos)
        << result.outcome.err;
    EXPECT_EQ(result.history_text.compare(0, history.size(), history), 0);
    EXPECT_DOUBLE_EQ(result.number("final_time"), 6e-9);
    EXPECT_LE(result.number("ledger_defect_max"), 1e-9);
    EXPECT_GT(result.number("steps"), stored_.number("steps"));
  }

  TEST_F(RestartRefused, HistoryThatIsNotThere)
  {
    fs::resize_file(stored_.directory / "history.csv", 1000);
    expect_refused("shorter");
  }

  TEST_F(RestartRefused, CommandLine)
  {
    const std::string file = small.file.string();
    const auto code = [&](const std::vector<std::string> &arguments) {
      return nsfd(workspace_, arguments).exit_code;
    };
    EXPECT_EQ(code({file, "--resume", "a", "--output", "b"}), 2);
    EXPECT_EQ(code({file, "--resume", "--force"}), 2);
    EXPECT_EQ(code({"--resume"}), 2);
    EXPECT_EQ(code({file, "--resume", "nothing here"}), 1);
    EXPECT_FALSE(fs::exists(workspace_.path() / "nothing here"));
    // the folder may follow, the file come before or after
    std::vector<std::string> arguments = {"--resume", "run", "--quiet", "--set",
                                          "Output/report=false"};
    for (const std::string &assignment : storing(small, every).set)
      arguments.insert(arguments.end(), {"--set", assignment});
    arguments.push_back(file);
    EXPECT_EQ(code(arguments), 0);
  }

  // A disk with no room: warnings, the last checkpoint whole, and the run goes
  // on where it can be resumed. Needs the right to mount.
  TEST(RestartDisk, Full)
  {
    const Workspace workspace;
    const fs::path disk = workspace.path() / "disk";
    const Disk small_disk(disk, "600k");
    if (!small_disk.mounted())
      GTEST_SKIP() << "no right to mount a small disk";
    const fs::path directory = disk / "run";
    const Launch launch = with(storing(small, every),
                               {"Mesh/cells=10, 10", "Output/fields=false"});
    const Launch first = with(launch, {"Time/end=1 ns"});
    const Outcome begun =
        Process(command_of(first, directory, {}), workspace.path()).wait(60.);
    EXPECT_EQ(begun.exit_code, 0) << begun.err;
    const std::string good = read_text(newest(directory));
    ASSERT_FALSE(good.empty());
    // leave 80 kB: for history.csv, for no checkpoint
    const auto room = fs::space(disk).available;
    ASSERT_GT(room, 80000u);
    write_text(disk / "filler", std::string(room - 80000, 'x'));
    const Outcome outcome =
        Process(command_of(launch, directory, {"--resume"}), workspace.path())
            .wait(60.);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("No space left on device"), std::string::npos)
        << outcome.err;
    EXPECT_TRUE(good == read_text(newest(directory)));
    EXPECT_FALSE(fs::exists(directory / "checkpoint.h5.part"));
    const auto summary = nlohmann::json::parse(
        read_text(directory / "summary.json"), nullptr, false);
    EXPECT_GT(summary["counters"].value("failed_checkpoints", 0.), 0.);
    fs::remove(disk / "filler");
    const std::string history = read_text(directory / "history.csv");
    const Outcome again =
        Process(command_of(launch, directory, {"--resume"}), workspace.path())
            .wait(60.);
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(history, read_text(directory / "history.csv"));
  }

  // A folder that becomes read-only under a run.
  TEST(RestartDisk, ReadOnly)
  {
    const Workspace workspace;
    const fs::path disk = workspace.path() / "disk";
    const Disk other_disk(disk, "10m");
    if (!other_disk.mounted())
      GTEST_SKIP() << "no right to mount a disk";
    const fs::path directory = disk / "run";
    const Launch launch = with(storing(small, every), {"Output/fields=false"});
    Process process(command_of(launch, directory, {}), workspace.path());
    EXPECT_EQ(process.wait(60.).exit_code, 0);
    const auto before = contents(directory);
    ASSERT_TRUE(other_disk.make_read_only());
    const Outcome outcome = Process(command_of(with(launch, {"Time/end=6 ns"}),
                                               directory, {"--resume"}),
                                    workspace.path())
                                .wait(60.);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_NE(outcome.err.find("Read-only file system"), std::string::npos)
        << outcome.err;
    EXPECT_TRUE(before == contents(directory));
  }
} // namespace end_to_end::test_restart_refused
