#include "parameters/parameter_file.h"
#include "small_scene.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <unistd.h>

namespace nsfd::test_parameter_files
{
  using small_scene_text::read_good;
  using small_scene_text::replaced;
  using small_scene_text::report_of;
  using small_scene_text::small_scene;

  // --- parameter files

  TEST(ParameterFiles, SyntaxOfDealII)
  {
    InputErrors errors;
    ParameterFile file;
    file.read_text("# title - text\n\n"
                   "set   dimension =  3   # comment\r\n"
                   "subsection  Interface :  my   line\n"
                   "\tset  where   = x > 1 && \\\n"
                   "      # in between\n"
                   "      y < 2 # and here\n"
                   "  set law =\n"
                   "end",
                   "f.prm", errors);
    EXPECT_EQ(errors.report(), "");
    ASSERT_NE(file.top().find("dimension"), nullptr);
    EXPECT_EQ(file.top().find("dimension")->value.text(), "3");
    const ParameterSection *section = file.find("Interface: my line");
    ASSERT_NE(section, nullptr);
    EXPECT_EQ(section->kind(), "Interface");
    EXPECT_EQ(section->block_name(), "my line");
    const SourceText &where = section->find("where")->value;
    EXPECT_EQ(where.text(), "x > 1 && y < 2");
    EXPECT_EQ(where.locate(0, 5).line, 5u);
    EXPECT_EQ(where.locate(9, 1).line, 7u);
    EXPECT_EQ(where.locate(9, 1).column, 6u);
    EXPECT_EQ(section->find("law")->value.text(), "");
  }

  TEST(ParameterFiles, Include)
  {
    const auto folder = std::filesystem::temp_directory_path() /
                        ("nsfd_input_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder / "parts");
    std::ofstream(folder / "parts" / "mesh.prm")
        << "subsection Mesh\n  set upper corner = 1, 1\n  set cells = 1, "
           "1\nend\n"
        << "include other.prm\n";
    std::ofstream(folder / "parts" / "other.prm") << "set dimension = 2\n";
    const std::string rest =
        small_scene.substr(small_scene.find("subsection Material"));
    std::ofstream(folder / "main.prm") << "include parts/mesh.prm\n" << rest;
    std::ofstream(folder / "loop.prm") << "\ninclude ./loop.prm\n";
    std::ofstream(folder / "twice.prm") << "set dimension = 2\n"
                                        << "include parts/other.prm\n";

    InputErrors errors;
    const auto scene = read_scene((folder / "main.prm").string(), {}, errors);
    EXPECT_EQ(errors.report(), "");
    ASSERT_NE(scene, nullptr);
    EXPECT_EQ(scene->mesh.upper, (std::vector<double>{1., 1.}));

    InputErrors loop;
    ParameterFile().read_file((folder / "loop.prm").string(), loop);
    EXPECT_NE(loop.report().find("loop.prm:2: error:"), std::string::npos);
    EXPECT_NE(loop.report().find("includes itself"), std::string::npos);

    InputErrors twice;
    ParameterFile().read_file((folder / "twice.prm").string(), twice);
    EXPECT_NE(twice.report().find("other.prm:1: error: `dimension` is given "
                                  "twice"),
              std::string::npos)
        << twice.report();
    std::filesystem::remove_all(folder);
  }

  TEST(ParameterFiles, WhatIsNoFileIsRefused)
  {
    InputErrors missing, folder;
    EXPECT_EQ(read_scene("no/such.prm", {}, missing), nullptr);
    EXPECT_NE(missing.report().find("`no/such.prm` cannot be read"),
              std::string::npos);
    EXPECT_EQ(missing.n_errors(), 1u);
    EXPECT_EQ(read_scene("/tmp", {}, folder), nullptr);
    EXPECT_NE(folder.report().find("is a folder"), std::string::npos);
  }

  TEST(Messages, AreSortedByLineAndCounted)
  {
    const std::string report =
        report_of(replaced(replaced(small_scene, "0.32", "0.7"),
                           "set dimension = 2", "set dimension = 5"));
    EXPECT_EQ(report,
              "small.prm:2: error: dimension = 5 must be at most 3\n"
              "   2 | set dimension = 5\n"
              "     |                 ^\n"
              "  write for example: 2\n"
              "small.prm:9: error: Poisson ratio = 0.7 must be greater than -1 "
              "and less than 0.5\n"
              "   9 |   set Poisson ratio = 0.7\n"
              "     |                       ^~~\n"
              "  write for example: 0.32\n"
              "2 errors, nothing was run\n");
  }

  TEST(Messages, OneFaultGivesOneError)
  {
    // what depends on a wrong value is not blamed as well
    for (const auto &[from, to] : std::vector<std::array<std::string, 2>>{
             {"135 GPa", "135 Gpa"},
             {"set Poisson ratio", "set Poison ratio"},
             {"set end", "set ende"},
             {"set law = rigid", "set law = rigit\n  set friction = 0.3"},
             {"set upper corner = 10 um, 20 um", "set upper corner = 10 um"},
             {"set cells = 2, 4", "set cells = 2, a"},
             {"set cells = 2, 4", "set type = brik\n  set cells = 2, 4"},
             {"set end = 10 ns", "set end = 10 ns\n  set theta = o.5"},
             {"set dimension = 2",
              "subsection Constants\n set a = b\nend\n"
              "subsection Loads\n set gravity = 0, a\nend"}}) {
      InputErrors errors;
      read_scene_text(replaced(small_scene, from, to), "f", {}, errors);
      EXPECT_EQ(errors.n_errors(), 1u) << errors.report();
    }
  }

  TEST(Messages, NearestNames)
  {
    EXPECT_EQ(nearest_name("strenght", {"stiffness", "strength"}), "strength");
    EXPECT_EQ(nearest_name("DEGREE", {"mass", "degree"}), "degree");
    EXPECT_EQ(nearest_name("modulus", {"Poisson ratio", "Young modulus"}),
              "Young modulus");
    EXPECT_EQ(nearest_name("banana", {"mass", "degree"}), "");
    EXPECT_EQ(nearest_name("q", {"x", "y"}), "");
    EXPECT_EQ(did_you_mean("mas", {"mass"}), "did you mean `mass`?");
  }

  TEST(Messages, LongLinesAndStrangeBytesStayReadable)
  {
    const std::string report = report_of(
        "set dimension = " + std::string(3000, ' ') + "7 \x01\n" + small_scene);
    EXPECT_NE(report.find("^"), std::string::npos);
    EXPECT_EQ(report.find('\x01'), std::string::npos);
    std::istringstream lines(report);
    for (std::string line; std::getline(lines, line);)
      EXPECT_LT(line.size(), 200u);
  }
} // namespace nsfd::test_parameter_files
