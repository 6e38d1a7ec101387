#include "program.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

// `nsfd solve`: exit codes, the committed problems with every solver, the
// public ones where they are at hand.

namespace end_to_end::test_solve
{
  namespace fs = std::filesystem;

  namespace
  {
    fs::path problems() { return fs::path(NSFD_SOURCE_DIR) / "tests/problems"; }

    std::vector<fs::path> files_of(const fs::path &folder)
    {
      std::vector<fs::path> files;
      for (const auto &entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".hdf5")
          files.push_back(entry.path());
      return files;
    }

    /** The problems that a table says are not solved. */
    std::vector<std::string> unsolved(const std::string &table)
    {
      std::vector<std::string> names;
      std::istringstream lines(table);
      for (std::string line; std::getline(lines, line);)
        if (line.find("NOT SOLVED") != std::string::npos)
          names.push_back(line.substr(0, line.find(' ')));
      return names;
    }

    bool contains(const std::string &text, const std::string &word)
    {
      return text.find(word) != std::string::npos;
    }
  } // namespace

  TEST(Solve, ExitCodesTellWhatHappened)
  {
    const Workspace workspace;
    const std::string one = files_of(problems()).front().string();
    const Outcome solved = nsfd(workspace, {"solve", one});
    EXPECT_EQ(solved.exit_code, 0) << solved.err;
    EXPECT_EQ(solved.err, "");
    for (const char *word : {"residual", "iterations", "CPU time", "contacts"})
      EXPECT_TRUE(contains(solved.out, word)) << solved.out;

    // far below the round-off of the measure
    const Outcome failed =
        nsfd(workspace, {"solve", one, "--tolerance", "1e-40"});
    EXPECT_EQ(failed.exit_code, 3) << failed.out;
    EXPECT_TRUE(contains(failed.out, "NOT below")) << failed.out;

    // a bad file stops the good one as well
    write_text(workspace.path() / "bad.hdf5", "no HDF5");
    const Outcome bad = nsfd(workspace, {"solve", one, "bad.hdf5", "absent"});
    EXPECT_EQ(bad.exit_code, 1);
    EXPECT_EQ(bad.out, "");
    EXPECT_TRUE(contains(bad.err, "bad.hdf5: it is not an HDF5 file"));
    EXPECT_TRUE(contains(bad.err, "absent: there is no such file"));

    EXPECT_EQ(files_below(workspace.path()).size(), 1u); // bad.hdf5
  }

  TEST(Solve, WrongUsageSaysWhatToWrite)
  {
    const Workspace workspace;
    const struct {
      std::vector<std::string> arguments;
      std::string text;
    } calls[] = {{{"solve"}, "no problem is named"},
                 {{"solve", "a.hdf5", "--solver", "newton"}, "dual newton"},
                 {{"solve", "a.hdf5", "--solver", "admn"}, "mean `admm`"},
                 {{"solve", "a.hdf5", "--tolerance", "0"}, "between 0 and 1"},
                 {{"solve", "a.hdf5", "--tolerance", "x"}, "--help"},
                 {{"solve", "a.hdf5", "--solve", "auto"}, "--solver"},
                 {{"solve", "."}, "must end in .hdf5"}};
    for (const auto &call : calls) {
      const Outcome outcome = nsfd(workspace, call.arguments);
      EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
      EXPECT_TRUE(contains(outcome.err, call.text)) << outcome.err;
    }
    const Outcome help = nsfd(workspace, {"solve", "--help"});
    EXPECT_EQ(help.exit_code, 0);
    for (const char *word : {"--solver", "--tolerance", "interior point"})
      EXPECT_TRUE(contains(help.out, word)) << help.out;
  }

  class SolveTest : public testing::TestWithParam<const char *>
  {
  };

  // Newton alone cycles on the hyperstatic piles; nothing else may fail
  TEST_P(SolveTest, OwnProblems)
  {
    const Workspace workspace;
    const Outcome outcome =
        nsfd(workspace, {"solve", problems().string(), "--solver", GetParam()});
    const std::vector<std::string> failed = unsolved(outcome.out);
    for (const std::string &name : failed)
      EXPECT_TRUE(GetParam() == std::string("dual newton") &&
                  contains(name, "pile"))
          << name;
    EXPECT_EQ(outcome.exit_code, failed.empty() ? 0 : 3)
        << outcome.out << outcome.err;
  }

  INSTANTIATE_TEST_SUITE_P(All, SolveTest,
                           testing::Values("auto", "admm", "dual newton",
                                           "gauss seidel", "interior point",
                                           "projected gradient", "proximal"),
                           [](const auto &info) {
                             std::string name = info.param;
                             for (char &c : name)
                               c = c == ' ' ? '_' : c;
                             return name;
                           });

  // 38 problems that come with another program; they are not ours to keep here
  TEST(Solve, PublicProblems)
  {
    const char *const folder = std::getenv("NSFD_CONTACT_PROBLEMS");
    if (!folder)
      GTEST_SKIP() << "NSFD_CONTACT_PROBLEMS names no folder";
    const Workspace workspace;
    ASSERT_GE(files_of(folder).size(), 38u);
    const Outcome outcome = nsfd(workspace, {"solve", folder});
    EXPECT_EQ(unsolved(outcome.out), std::vector<std::string>())
        << outcome.out << outcome.err;
    EXPECT_EQ(outcome.exit_code, 0);
  }
} // namespace end_to_end::test_solve
