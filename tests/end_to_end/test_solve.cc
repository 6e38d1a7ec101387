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
                 {{"solve", "a.hdf5", "--attempts", "0"}, "from 1"},
                 {{"solve", "a.hdf5", "--attempts", "-3"}, "--help"},
                 {{"solve", "."}, "must end in .hdf5"}};
    for (const auto &call : calls) {
      const Outcome outcome = nsfd(workspace, call.arguments);
      EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
      EXPECT_TRUE(contains(outcome.err, call.text)) << outcome.err;
    }
    const Outcome help = nsfd(workspace, {"solve", "--help"});
    EXPECT_EQ(help.exit_code, 0);
    for (const char *word :
         {"--solver", "--tolerance", "--attempts", "--write", "interior point"})
      EXPECT_TRUE(contains(help.out, word)) << help.out;
  }

  TEST(Solve, RestartsAreCounted)
  {
    const Workspace workspace;
    const std::string one = (problems() / "pile_3d.hdf5").string();
    // far below the round-off of the measure
    const Outcome failed = nsfd(
        workspace, {"solve", one, "--tolerance", "1e-40", "--attempts", "3"});
    EXPECT_EQ(failed.exit_code, 3);
    EXPECT_TRUE(contains(failed.out, "attempts       3; the answer is of "))
        << failed.out;
    const Outcome table = nsfd(workspace, {"solve", one, one});
    std::istringstream lines(table.out);
    std::string line;
    std::getline(lines, line);
    EXPECT_TRUE(contains(line, "CPU time attempts")) << line;
    std::getline(lines, line);
    EXPECT_TRUE(contains(line, "ms        1")) << line;
  }

  // the answers are problems themselves, in files of the same names
  TEST(Solve, WritesAnswersIntoTheFolderAndOverNoFile)
  {
    const Workspace workspace;
    const fs::path folder = workspace.path() / "answers";
    const Outcome written =
        nsfd(workspace, {"solve", problems().string(), "--write", "answers"});
    EXPECT_EQ(written.exit_code, 0) << written.err;
    EXPECT_EQ(files_of(folder).size(), files_of(problems()).size());
    for (const fs::path &file : files_of(problems()))
      EXPECT_TRUE(contains(read_text(folder / file.filename()), "solution"));
    const Outcome again = nsfd(workspace, {"solve", "answers"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    nsfd(workspace, {"solve", problems().string(), "--write", "same"});
    for (const fs::path &file : files_of(folder))
      EXPECT_EQ(read_text(workspace.path() / "same" / file.filename()),
                read_text(file));

    // nothing is solved where one of them would meet a file, or another
    const std::string before = read_text(folder / "pile_3d.hdf5");
    fs::remove(folder / "brick_3d.hdf5");
    const Outcome met =
        nsfd(workspace, {"solve", problems().string(), "--write", "answers"});
    EXPECT_EQ(met.exit_code, 1);
    EXPECT_EQ(met.out, "");
    EXPECT_TRUE(contains(met.err, "is there already")) << met.err;
    EXPECT_FALSE(fs::exists(folder / "brick_3d.hdf5"));
    EXPECT_EQ(read_text(folder / "pile_3d.hdf5"), before);
    const std::string one = (problems() / "brick_3d.hdf5").string();
    const Outcome twice =
        nsfd(workspace, {"solve", one, one, "--write", "others"});
    EXPECT_EQ(twice.exit_code, 1);
    EXPECT_TRUE(contains(twice.err, "would be one file")) << twice.err;
    EXPECT_FALSE(fs::exists(workspace.path() / "others"));

    // a link that leads nowhere is a file, and a file is no folder
    fs::create_symlink("outside.hdf5", folder / "brick_3d.hdf5");
    EXPECT_EQ(nsfd(workspace, {"solve", one, "--write", "answers"}).exit_code,
              1);
    EXPECT_FALSE(fs::exists(folder / "outside.hdf5"));
    write_text(workspace.path() / "file", "");
    const Outcome no_folder =
        nsfd(workspace, {"solve", one, "--write", "file"});
    EXPECT_EQ(no_folder.exit_code, 1);
    EXPECT_TRUE(contains(no_folder.err, "cannot be a folder")) << no_folder.err;
  }

  // what is not solved is written as well, and the exit code tells
  TEST(Solve, WritesTheBestAnswerOfWhatIsNotSolved)
  {
    const Workspace workspace;
    const std::string one = (problems() / "brick_3d.hdf5").string();
    const Outcome outcome =
        nsfd(workspace, {"solve", one, "--tolerance", "1e-40", "--attempts",
                         "2", "--write", "answers"});
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_TRUE(fs::exists(workspace.path() / "answers/brick_3d.hdf5"));
  }

  // as a run writes them with `save problems = all`
  TEST(Solve, AThousandProblemsInOneStart)
  {
    const Workspace workspace;
    const fs::path folder = workspace.path() / "many";
    fs::create_directory(folder);
    for (unsigned int k = 0; k < 1000; ++k)
      fs::copy_file(problems() / "brick_3d.hdf5",
                    folder / ("p" + std::to_string(k) + ".hdf5"));
    const Outcome outcome =
        nsfd(workspace, {"solve", "many", "--write", "answers"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.out, "1000 of 1000 solved"));
    EXPECT_EQ(files_of(workspace.path() / "answers").size(), 1000u);
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
    const Outcome tight =
        nsfd(workspace, {"solve", folder, "--tolerance", "1e-10"});
    EXPECT_EQ(unsolved(tight.out), std::vector<std::string>())
        << tight.out << tight.err;
  }
} // namespace end_to_end::test_solve
