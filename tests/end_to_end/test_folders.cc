#include "disk.h"
#include "restart.h"

#include <gtest/gtest.h>

#include <csignal>

// Folders of results: whose files are replaced, who writes to them, and what is
// said when that is not possible.

namespace end_to_end::test_folders
{
  namespace fs = std::filesystem;

  namespace
  {
    const Launch small = {scene("midplane"),
                          {"Mesh/cells=6, 6", "Time/end=1 ns"}};

    Outcome run_in(const Workspace &workspace, const fs::path &directory,
                   const std::vector<std::string> &more = {},
                   const Launch &what = small)
    {
      return Process(command_of(what, directory, more), workspace.path())
          .wait(60.);
    }

    void expect_words(const Outcome &outcome, const int code,
                      const std::vector<std::string> &words)
    {
      EXPECT_EQ(outcome.exit_code, code) << outcome.err;
      EXPECT_EQ(outcome.err.find("internal error"), std::string::npos)
          << outcome.err;
      for (const std::string &word : words) {
        const auto found = outcome.err.find(word);
        EXPECT_NE(found, std::string::npos) << outcome.err;
        if (found != std::string::npos) {
          EXPECT_EQ(outcome.err.find(word, found + 1), std::string::npos)
              << "said twice: " << outcome.err;
        }
      }
    }

    nlohmann::json json_of(const fs::path &file)
    {
      return nlohmann::json::parse(read_text(file), nullptr, false);
    }
  } // namespace

  TEST(Folders, ForceReplacesWhatTheRunHasListed)
  {
    const Workspace workspace;
    const fs::path directory = workspace.path() / "run";
    const Launch scene_inside = {directory / "scene.prm", small.set};
    fs::create_directories(directory);
    ASSERT_EQ(run_in(workspace, workspace.path() / "first").exit_code, 0);
    fs::remove(directory);
    fs::rename(workspace.path() / "first", directory);
    EXPECT_EQ(json_of(directory / "run.json")["files"]
                  .get<std::vector<std::string>>(),
              files_below(directory))
        << "exactly what is there";

    fs::copy_file(small.file, directory / "scene.prm");
    const std::vector<std::string> mine = {"thesis.csv", "logo.svg",
                                           "notes.vtu", "my.json", "page.html"};
    for (const std::string &name : mine)
      write_text(directory / name, "mine");
    const std::string before = read_text(directory / "history.csv");
    const Outcome outcome = run_in(workspace, directory, {"--force"},
                                   with(scene_inside, {"Time/end=0.5 ns"}));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_LT(read_text(directory / "history.csv").size(), before.size());
    for (const std::string &name : mine)
      EXPECT_EQ(read_text(directory / name), "mine") << name;
    EXPECT_EQ(read_text(directory / "scene.prm"), read_text(small.file));
  }

  // One of an older program, and one that no run has filled.
  TEST(Folders, WithoutAList)
  {
    const Workspace workspace;
    const fs::path directory = workspace.path() / "run";
    ASSERT_EQ(run_in(workspace, directory).exit_code, 0);
    auto description = json_of(directory / "run.json");
    description.erase("files");
    write_text(directory / "run.json", description.dump());
    write_text(directory / "thesis.csv", "mine");
    EXPECT_EQ(run_in(workspace, directory, {"--force"}).exit_code, 0);
    EXPECT_EQ(read_text(directory / "thesis.csv"), "mine");

    const fs::path other = workspace.path() / "other";
    fs::create_directories(other);
    write_text(other / "history.csv", "mine");
    for (const std::vector<std::string> &more :
         {std::vector<std::string>(), {"--force"}})
      expect_words(run_in(workspace, other, more), 1, {"nothing was run"});
    EXPECT_EQ(read_text(other / "history.csv"), "mine");
    EXPECT_EQ(files_below(other), std::vector<std::string>{"history.csv"});
  }

  TEST(Folders, OneRunAtATime)
  {
    const Workspace workspace;
    const fs::path directory = workspace.path() / "run";
    const Launch slow = with(small, {"Time/step=1e-4 courant"});
    Process first(command_of(slow, directory, {}), workspace.path());
    ASSERT_TRUE(wait_for_rows(directory, 2));
    for (const char *option : {"--force", "--resume"})
      expect_words(run_in(workspace, directory, {option}, slow), 1,
                   {"in use by process ", "nothing was run"});
    first.send(SIGKILL);
    first.wait(10.);
    EXPECT_EQ(run_in(workspace, directory, {"--force"}).exit_code, 0)
        << "the lock ends with its process";
  }

  TEST(Folders, LinksAreNotFollowed)
  {
    const Workspace workspace;
    const fs::path directory = workspace.path() / "run",
                   outside = workspace.path() / "outside";
    fs::create_directories(outside);
    write_text(outside / "precious", "mine");
    ASSERT_EQ(run_in(workspace, directory).exit_code, 0);
    for (const char *name : {"history.csv", "summary.json", "run.json.part",
                             "summary.json.part", "units.json"}) {
      fs::remove(directory / name);
      fs::create_symlink(outside / "precious", directory / name);
    }
    const Outcome outcome = run_in(workspace, directory, {"--force"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(read_text(outside / "precious"), "mine");
    EXPECT_FALSE(fs::is_symlink(directory / "history.csv"));
    // a folder in it that leads out
    fs::create_directory_symlink(outside, directory / "observables");
    const Outcome refused =
        run_in(workspace, directory, {"--force"},
               with(small, {"Observable: pull/type=reaction",
                            "Observable: pull/on=left"}));
    expect_words(refused, 5, {"links are not followed"});
    EXPECT_EQ(files_below(outside), std::vector<std::string>{"precious"});
  }

  TEST(Folders, ThatAreNone)
  {
    const Workspace workspace;
    write_text(workspace.path() / "file", "mine");
    expect_words(run_in(workspace, workspace.path() / "file"), 1,
                 {"is no folder"});
    expect_words(run_in(workspace, workspace.path() / "file" / "below"), 1,
                 {"Not a directory"});
    Launch two = small;
    two.ranks = 2;
    expect_words(run_in(workspace, workspace.path() / "file", {}, two), 1,
                 {"is no folder"});
    EXPECT_EQ(read_text(workspace.path() / "file"), "mine");
  }

  // Needs the right to mount.
  TEST(FolderDisk, ReadOnly)
  {
    const Workspace workspace;
    const Disk disk(workspace.path() / "disk", "1m");
    if (!disk.mounted())
      GTEST_SKIP() << "no right to mount a disk";
    fs::create_directories(workspace.path() / "disk" / "run");
    ASSERT_TRUE(disk.make_read_only());
    for (const char *name : {"run", "new"})
      expect_words(run_in(workspace, workspace.path() / "disk" / name), 1,
                   {"Read-only file system"});
  }

  // No room for fields or for rows, on one rank and on two: the fact, once.
  TEST(FolderDisk, Full)
  {
    const Workspace workspace;
    const Launch writing =
        with(small, {"Output/fields every steps=1", "Time/step=0.05 courant"});
    struct Case {
      const char *name, *format;
      unsigned int ranks;
    };
    for (const Case &one : {Case{"vtu", "vtu", 1},
                            {"hdf5", "hdf5", 1},
                            {"hdf5_start", "hdf5", 1},
                            {"vtkhdf", "vtkhdf", 1},
                            {"two", "vtu", 2}}) {
      SCOPED_TRACE(one.name);
      const fs::path place = workspace.path() / one.name;
      const Disk disk(place,
                      one.name == std::string("hdf5_start") ? "60k" : "400k");
      if (!disk.mounted())
        GTEST_SKIP() << "no right to mount a disk";
      Launch launch =
          with(writing, {std::string("Output/format=") + one.format});
      launch.ranks = one.ranks;
      expect_words(run_in(workspace, place / "run", {}, launch), 5,
                   {"No space left on device"});
    }
  }

  TEST(Folders, HistoryBeginsAtStepZeroAndHasUnits)
  {
    const Workspace workspace;
    const Result result = good_run(workspace, "run", small);
    ASSERT_TRUE(result.completed());
    EXPECT_EQ(result.history["step"].front(), 0.);
    EXPECT_EQ(result.history["time"].front(), 0.);
    EXPECT_EQ(double(result.history.size()), result.number("steps") + 1.);
    const auto units = json_of(result.directory / "units.json");
    for (const std::string &name : result.history.names())
      EXPECT_TRUE(units["history.csv"].contains(name)) << name;
    for (const auto &[key, value] : result.summary.items())
      if (value.is_number() || key == "energy" || key == "dissipated") {
        EXPECT_TRUE(units["summary.json"].contains(key)) << key;
      }
    EXPECT_EQ(units["history.csv"]["damage"], "J/m");
    EXPECT_GE(result.number("loop_cpu_seconds"), 0.);
    EXPECT_LT(result.number("loop_cpu_seconds"), result.number("cpu_seconds"));
  }

  TEST(Folders, StrictRuns)
  {
    const Workspace workspace;
    const Launch bad = {scene("midplane"),
                        {"Time/step=2 courant", "Mesh/cells=6, 6"}};
    const Outcome lax = run_in(workspace, workspace.path() / "lax", {}, bad);
    EXPECT_EQ(lax.exit_code, 0) << lax.err;
    ASSERT_FALSE(
        json_of(workspace.path() / "lax" / "summary.json")["certificate"]["ok"]
            .get<bool>());
    EXPECT_EQ(run_in(workspace, workspace.path() / "strict", {"--strict"}, bad)
                  .exit_code,
              7);
  }
} // namespace end_to_end::test_folders
