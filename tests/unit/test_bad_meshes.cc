// Files of meshes that are no meshes, or that break what reads them.

#include "core/lock_process.h"
#include "named_mesh_scene.h"

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <sys/wait.h>

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cmath>

using namespace nsfd;
using namespace nsfd::test;

namespace test_bad_meshes
{
  struct File {
    std::vector<std::string> nodes;
    std::vector<std::string> elements; ///< "3 2 1 1 1 2 3 4": type, tags, nodes

    std::string text() const
    {
      std::string result = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" +
                           std::to_string(nodes.size()) + "\n";
      for (std::size_t i = 0; i < nodes.size(); ++i)
        result += std::to_string(i + 1) + " " + nodes[i] + "\n";
      result +=
          "$EndNodes\n$Elements\n" + std::to_string(elements.size()) + "\n";
      // numbers that are not those of their order
      for (std::size_t i = 0; i < elements.size(); ++i)
        result += std::to_string(i + 11) + " " + elements[i] + "\n";
      return result + "$EndElements\n";
    }
  };

  std::string errors_of_mesh(const unsigned int dimension, const File &file)
  {
    const TemporaryFile written("bad.msh", file.text());
    return errors_of(mesh_scene(dimension, written.entries()));
  }

  void expect_error(const std::string &errors, const std::string &part)
  {
    EXPECT_NE(errors.find(part), std::string::npos) << part << "\n" << errors;
  }

  std::string errors_of_script(const std::string &text,
                               const std::string &more = "")
  {
    const TemporaryFile written("bad.geo", text);
    return errors_of(mesh_scene(2, written.entries(more)));
  }

  TEST(BadMeshes, FoldedCells)
  {
    // the middle one is folded back onto the first
    const std::string errors = errors_of_mesh(
        2, {{"0 0 0", "1 0 0", "1 1 0", "0 1 0", "0 .9 0", "1 .9 0", "0 2 0",
             "1 2 0"},
            {"3 2 1 1 1 2 3 4", "3 2 1 1 4 3 6 5", "3 2 1 1 5 6 8 7"}});
    expect_error(errors, "cell 11 at (0.5, 0.5) and cell 12 at (0.5, 0.95) are "
                         "on the same side of the face that they share");
  }

  TEST(BadMeshes, FoldedTetrahedra)
  {
    const std::string errors =
        errors_of_mesh(3, {{"0 0 0", "1 0 0", "0 1 0", "0 0 1", ".1 .1 .5"},
                           {"4 2 1 1 1 2 3 4", "4 2 1 1 1 2 3 5"}});
    expect_error(errors, "cell 11 at (0.25, 0.25, 0.25) and cell 12");
  }

  TEST(BadMeshes, DoubledCells)
  {
    const std::vector<std::string> square = {"0 0 0", "1 0 0", "1 1 0",
                                             "0 1 0"};
    expect_error(
        errors_of_mesh(2, {square, {"3 2 1 1 1 2 3 4", "3 2 1 1 2 3 4 1"}}),
        "cell 12 at (0.5, 0.5) is the same as cell 11 at (0.5, 0.5)");
    // one cell of two groups
    EXPECT_EQ(
        errors_of_mesh(2, {square, {"3 2 1 1 1 2 3 4", "3 2 2 2 1 2 3 4"}}),
        "");
  }

  TEST(BadMeshes, OverlappingCellsWithoutACommonFace)
  {
    const auto two_squares = [](const double x) {
      const std::string a = std::to_string(x), b = std::to_string(x + 1.);
      return errors_of_mesh(2,
                            {{"0 0 0", "1 0 0", "1 1 0", "0 1 0", a + " .5 0",
                              b + " .5 0", b + " 1.5 0", a + " 1.5 0"},
                             {"3 2 1 1 1 2 3 4", "3 2 2 2 5 6 7 8"}});
    };
    expect_error(two_squares(.5), "cell 11 at (0.5, 0.5) and cell 12 at (1, 1) "
                                  "overlap");
    // bodies that touch, and what two polygons of one circle have
    EXPECT_EQ(two_squares(1.), "");
    EXPECT_EQ(two_squares(.95), "");
    // in space: two hexes, and two tetrahedra that cross at their edges
    const auto cube = [](const std::string &lower, const std::string &upper) {
      std::vector<std::string> nodes;
      for (const std::string &z : {lower, upper}) {
        nodes.push_back(lower + " " + lower + " " + z);
        nodes.push_back(upper + " " + lower + " " + z);
        nodes.push_back(upper + " " + upper + " " + z);
        nodes.push_back(lower + " " + upper + " " + z);
      }
      return nodes;
    };
    const auto two_cubes = [&](const std::string &lower,
                               const std::string &upper) {
      auto nodes = cube("0", "1");
      const auto others = cube(lower, upper);
      nodes.insert(nodes.end(), others.begin(), others.end());
      return errors_of_mesh(
          3, {nodes,
              {"5 2 1 1 1 2 3 4 5 6 7 8", "5 2 2 2 9 10 11 12 13 14 15 16"}});
    };
    expect_error(two_cubes(".5", "1.5"), "overlap");
    EXPECT_EQ(two_cubes("1", "2"), "");
    const auto crossed = [](const std::string &z) {
      return errors_of_mesh(3,
                            {{"-1 0 0", "1 0 0", "0 -1 -1", "0 1 -1",
                              "0 -1 " + z, "0 1 " + z, "-1 0 1.5", "1 0 1.5"},
                             {"4 2 1 1 1 2 3 4", "4 2 2 2 5 6 7 8"}});
    };
    expect_error(crossed("-.5"), "overlap");
    EXPECT_EQ(crossed(".1"), "");
  }

  TEST(BadMeshes, InvertedFlatAndInfiniteCells)
  {
    expect_error(errors_of_mesh(2, {{"0 0 0", "1 0 0", ".2 .2 0", "0 1 0"},
                                    {"3 2 1 1 1 2 3 4"}}),
                 "cell 11 at (0.3, 0.3) is inverted");
    expect_error(errors_of_mesh(3, {{"0 0 0", "1 0 0", "0 1 0", ".3 .3 0"},
                                    {"4 2 1 1 1 2 3 4"}}),
                 "cell 11 at (0.325, 0.325, 0) is degenerate");
    expect_error(
        errors_of_mesh(2, {{"0 0 0", "nan 0 0", "0 1 0"}, {"2 2 1 1 1 2 3"}}),
        "bad.msh");
  }

  TEST(BadMeshes, CellsOfAnyLengthButNotOfAnyWidth)
  {
    const auto errors_of_length = [](const std::string &x) {
      return errors_of_mesh(
          2, {{"0 0 0", "1 0 0", "1 1 0", "0 1 0", x + " 0 0", x + " 1 0"},
              {"3 2 1 1 1 2 3 4", "3 2 1 1 2 5 6 3"}});
    };
    EXPECT_EQ(errors_of_length("900001"), "");
    expect_error(errors_of_length("4294967296"),
                 "has edges of 4.29e+09 and of 1, and none may be longer than "
                 "1e+06 times another");
  }

  TEST(BadMeshes, WhatBreaksGmshIsSaid)
  {
    // a list that no memory holds
    expect_error(errors_of_script("x() = LinSpace(0, 1, 2000000000);"),
                 "GiB of memory");
    // a loop without an end
    expect_error(errors_of_script("For i In {1:1e12}\n x = i;\nEndFor",
                                  "set meshing time = 1\n"),
                 "Gmsh took more than 1 s");
    // an endless chain of calls overruns the stack or the time
    const std::string calls = errors_of_script(
        "Macro a\nCall a;\nReturn\nCall a;", "set meshing time = 1\n");
    expect_error(calls, "bad.geo");
    expect_error(errors_of_script("Point(1) = {0, 0, 0;"), "syntax error");
  }

  TEST(BadMeshes, OnlyListedNamesAreRead)
  {
    for (const char *name :
         {"a.txt", "a.opt", "a.pos", "a.stl", "a.py", "a.m", "a.exe", "a.pro",
          "a.gz", "a.geo_", "a.med", "a.cgns", "a"}) {
      const TemporaryFile file(name, "SystemCall \"touch nsfd_was_run\";\n");
      expect_error(errors_of(mesh_scene(2, file.entries())),
                   "its name must end in one of .msh, .geo");
    }
    // a script under the name of something else is no script
    for (const char *name : {"a.msh", "a.MSH", "a.step", "a.Brep", "a.iges",
                             "a.unv", "a.Mesh", "a.bdf", "a.vtk", "a.inp"}) {
      const TemporaryFile file(name, "SystemCall \"touch nsfd_was_run\";\n");
      EXPECT_NE(errors_of(mesh_scene(2, file.entries())), "") << name;
    }
    const TemporaryFile script("a.dat", "SystemCall \"touch nsfd_was_run\";\n");
    expect_error(errors_of(mesh_scene(2, script.entries("set format = geo"))),
                 "`SystemCall` runs a command");
    expect_error(errors_of(mesh_scene(2, script.entries("set format = gmsh"))),
                 "does not begin with $MeshFormat");
    expect_error(errors_of(mesh_scene(2, script.entries("set format = cad"))),
                 "the name of a CAD file must end in");
    EXPECT_FALSE(std::ifstream("nsfd_was_run"));
  }

  TEST(BadMeshes, ALockedProcessCannotAct)
  {
    const std::string file = testing::TempDir() + "nsfd_locked",
                      folder = file + "_folder";
    const int open_file = open(file.c_str(), O_WRONLY | O_CREAT, 0600);
    ASSERT_GE(open_file, 0);
    const pid_t pid = fork();
    if (pid == 0) {
      lock_process({10., 0x1p30});
      signal(SIGXFSZ, SIG_IGN);
      char name[] = "/bin/true";
      char *const words[] = {name, nullptr};
      int can = write(open_file, "x", 1) == 1 ? 1 : 0;
      can |=
          open((file + "_new").c_str(), O_WRONLY | O_CREAT, 0600) >= 0 ? 2 : 0;
      can |= mkdir(folder.c_str(), 0700) == 0 ? 4 : 0;
      can |= unlink(file.c_str()) == 0 ? 8 : 0;
      // reading is what it is for
      can |= open("/proc/self/exe", O_RDONLY) < 0 ? 16 : 0;
      execv(name, words);
      _exit(can);
    }
    int status = 0;
    ASSERT_EQ(waitpid(pid, &status, 0), pid);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0);
    struct stat entry;
    ASSERT_EQ(fstat(open_file, &entry), 0);
    EXPECT_EQ(entry.st_size, 0);
    EXPECT_EQ(access(file.c_str(), F_OK), 0);
    EXPECT_NE(access((file + "_new").c_str(), F_OK), 0);
    EXPECT_NE(access(folder.c_str(), F_OK), 0);
    close(open_file);
    unlink(file.c_str());
  }

  TEST(BadMeshes, OptionsBesideAFileAreNotRead)
  {
    const TemporaryFile options("bad.msh.opt", "Mesh.ScalingFactor = 7;\n"
                                               "Error(\"read\");\n");
    EXPECT_EQ(
        errors_of_mesh(2, {{"0 0 0", "1 0 0", "0 1 0"}, {"2 2 1 1 1 2 3"}}),
        "");
  }
} // namespace test_bad_meshes
