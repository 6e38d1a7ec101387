#include "compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// Meshes of files in whole runs: exact uniform stress, open cracks by group,
// any number of ranks, what a user reads about his mesh, and bad files.

namespace end_to_end::test_meshes
{
  namespace
  {
    namespace fs = std::filesystem;

    std::string mesh_file(const std::string &name)
    {
      return (fs::path(NSFD_SOURCE_DIR) / "tests" / "meshes" / name).string();
    }

    /** The plate of tests/meshes/plate.geo, 2 mm x 1 mm; a block of `more`. */
    std::string plate(const std::string &file, const std::string &more,
                      const std::string &time)
    {
      return "# plate - a mesh with named groups.\n"
             "set plane = stress\n"
             "subsection Mesh\n"
             "  set type        = file\n"
             "  set file        = " +
             mesh_file(file) +
             "\n  set length unit = mm\nend\n"
             "subsection Material: left half\n"
             "  set where         = steel\n"
             "  set Young modulus = 200 GPa\n"
             "  set Poisson ratio = 0.3\n"
             "  set density       = 7800 kg/m^3\nend\n"
             "subsection Material: right half\n"
             "  set where         = glue\n"
             "  set Young modulus = 200 GPa\n"
             "  set Poisson ratio = 0.3\n"
             "  set density       = 7800 kg/m^3\nend\n" +
             more + "subsection Time\n" + time + "end\n";
    }

    const std::string statics = "  set scheme = quasi-static\n"
                                "  set end    = 1\n  set step   = 1\n";

    std::string pulled(const std::string &where, const std::string &component,
                       const std::string &stress)
    {
      return "subsection Boundary: " + where + "\n  set where = " + where +
             "\n  set traction " + component + " = " + stress + " * t\nend\n";
    }

    const std::string joined = "subsection Interface: elsewhere\n"
                               "  set law = rigid\nend\n";

    const std::string open_crack = "subsection Interface: open\n"
                                   "  set where     = crack\n"
                                   "  set law       = camacho-ortiz\n"
                                   "  set strength  = 300 MPa\n"
                                   "  set toughness = 500 J/m^2\n"
                                   "  set broken    = true\nend\n";

    Result run_text(const Workspace &workspace, const std::string &name,
                    const std::string &text, Launch launch = {})
    {
      write_text(workspace.path() / (name + ".prm"), text);
      launch.file = workspace.path() / (name + ".prm");
      return good_run(workspace, name, launch);
    }

    Outcome check(const Workspace &workspace, const std::string &text)
    {
      write_text(workspace.path() / "checked.prm", text);
      return nsfd(workspace, {"checked.prm", "--check"});
    }
  } // namespace

  TEST(Meshes, UniformStressIsExactOnMeshesOfFiles)
  {
    for (const char *file :
         {"plate_41_ascii.msh", "plate_22_binary.msh", "plate_quads.msh"})
      for (const char *component : {"x", "y"}) {
        const bool along = *component == 'x';
        const Workspace workspace;
        const Result result = run_text(
            workspace, "patch",
            plate(
                file,
                joined +
                    pulled(along ? "left end" : "bottom", component, "-1 MPa") +
                    pulled(along ? "right end" : "top", component, "1 MPa"),
                statics + "  set equilibrium tolerance = 1e-13\n"));
        ASSERT_TRUE(result.completed()) << result.description();
        double worst = 0.;
        unsigned int n_points = 0;
        const auto all = snapshots(result.directory, "fields");
        const auto &stress = all.back().at("stress"); // under the whole load
        for (std::size_t i = 0; i + 5 < stress.size(); i += 6, ++n_points)
          for (unsigned int c : {0u, 1u, 3u}) {
            const double exact = c == (along ? 0u : 1u) ? 1e6 : 0.;
            worst = std::max(worst, std::abs(stress[i + c] - exact) / 1e6);
          }
        EXPECT_GT(n_points, 0u);
        expect_below(std::string(file) + ", stress along " + component, worst,
                     1e-10, "linear displacements are in the space");
      }
  }

  // The elastic energy of an open crack is not known exactly here; that the
  // crack faces part, and only there, is.
  TEST(Meshes, CrackByGroupIsOpen)
  {
    for (const char *file : {"plate_41_ascii.msh", "plate_quads.msh"}) {
      const Workspace workspace;
      const std::string load =
          pulled("bottom", "y", "-1 MPa") + pulled("top", "y", "1 MPa");
      const Result whole =
          run_text(workspace, "whole", plate(file, joined + load, statics));
      const Result cracked =
          run_text(workspace, "cracked",
                   plate(file, open_crack + joined + load, statics));
      ASSERT_TRUE(whole.completed() && cracked.completed());
      // V sigma^2 / (2 E)
      EXPECT_NEAR(whole.history["elastic"].back() / (2e-6 * 1e12 / 4e11), 1.,
                  1e-9);
      EXPECT_GT(cracked.history["elastic"].back(),
                1.1 * whole.history["elastic"].back());
      const auto faces = snapshots(cracked.directory, "interfaces");
      const auto &beta = faces.back().at("beta");
      EXPECT_GT(std::count(beta.begin(), beta.end(), 0.), 0);
      EXPECT_GT(std::count(beta.begin(), beta.end(), 1.), 0);
    }
  }

  TEST(Meshes, RanksAgreeBitForBit)
  {
    const Workspace workspace;
    const std::string springs = "subsection Interface: springs\n"
                                "  set law                  = elastic\n"
                                "  set normal stiffness     = 2e15\n"
                                "  set tangential stiffness = 1e15\nend\n"
                                "subsection Boundary: right end\n"
                                "  set where      = right end\n"
                                "  set velocity x = 1 m/s\nend\n";
    const std::string time = "  set end = 0.3 us\n  set step = 0.5 courant\n";
    for (const char *file : {"plate_41_binary.msh", "plate.geo"}) {
      const std::string text = plate(file, open_crack + springs, time);
      Launch launch;
      launch.set = {"Output/fields=false"};
      const Result one = run_text(workspace, "one", text, launch);
      launch.ranks = 2;
      const Result two = run_text(workspace, "two", text, launch);
      ASSERT_TRUE(one.completed() && two.completed());
      EXPECT_EQ(one.history_text, two.history_text) << file;
      fs::remove_all(one.directory);
      fs::remove_all(two.directory);
    }
  }

  TEST(Meshes, CheckListsGroups)
  {
    const Workspace workspace;
    const Outcome outcome =
        check(workspace,
              plate("plate_second_order.msh",
                    open_crack + joined + pulled("right end", "x", "1 MPa"),
                    statics));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const char *line :
         {"cells      86 triangles",
          "group      steel (surface 1): 42 cells, used by Material: left half",
          "group      crack (curve 14): 2 faces between cells, used by "
          "Interface: open",
          "group      right end (curve 12): 4 faces on the boundary, used by "
          "Boundary: right end",
          "group      seam (curve 13): 4 faces between cells, not used",
          "mesh note  86 cells are of higher order"})
      EXPECT_NE(outcome.out.find(line), std::string::npos) << line << "\n"
                                                           << outcome.out;
  }

  // Grains of Neper by their groups, and by the numbers that the file gives
  // them: the same scene, to the last bit.
  TEST(Meshes, CellDataAreAsGoodAsGroups)
  {
    const auto scene = [](const std::string &first, const std::string &between,
                          const std::string &others) {
      const std::string law = "  set law       = camacho-ortiz\n"
                              "  set strength  = 30 MPa\n"
                              "  set toughness = 40 J/m^2\n";
      return "# grains - pulled apart.\nsubsection Mesh\n  set type = file\n"
             "  set file = " +
             mesh_file("grains_neper.msh") +
             "\n  set length unit = mm\nend\n"
             "subsection Material: crystals\n  set model = cubic\n"
             "  set C11 = 168 GPa\n  set C12 = 121 GPa\n  set C44 = 75 GPa\n"
             "  set density = 8960\n  set orientation = cell data\nend\n"
             "subsection Interface: first\n" +
             law + first + "end\n" + between +
             (between.empty() ? "" : law + "  set strength factor = 2\nend\n") +
             "subsection Interface: others\n" + law + others +
             "end\n"
             "subsection Boundary: x0\n  set velocity x = -10 m/s\nend\n"
             "subsection Boundary: periodic x1\n"
             "  set velocity x = 10 m/s\nend\n"
             "subsection Time\n  set scheme = explicit\n  set end = 0.4 us\n"
             "  set step = auto\nend\n";
    };
    const Workspace workspace;
    Launch launch;
    launch.set = {"Output/fields=false"};
    const Result by_group =
        run_text(workspace, "groups",
                 scene("  set where = face1\n  set strength factor = 0.5\n",
                       "subsection Interface: between\n  set where = edge7\n",
                       "  set strength factor = 3\n"),
                 launch);
    // group 1 in the first grain, 3 in the second, 2 between them
    const std::string by_number =
        scene("  set where = group == 1\n  set strength factor = group / 2\n",
              "", "  set strength factor = group\n");
    const Result by_data = run_text(workspace, "data", by_number, launch);
    launch.ranks = 2;
    const Result by_two = run_text(workspace, "two", by_number, launch);
    ASSERT_TRUE(by_group.completed() && by_data.completed() &&
                by_two.completed());
    EXPECT_EQ(by_group.history_text, by_data.history_text);
    EXPECT_EQ(by_data.history_text, by_two.history_text);
  }

  TEST(Meshes, BadFilesStopBeforeTheFirstStep)
  {
    const Workspace workspace;
    const std::string bad = (workspace.path() / "bad.msh").string();
    const std::string whole = read_text(mesh_file("plate_41_binary.msh"));
    std::string text = plate("plate_41_binary.msh", joined, statics);
    const std::string good = mesh_file("plate_41_binary.msh");
    text.replace(text.find(good), good.size(), "bad.msh");
    for (const std::string &content :
         {std::string("nothing of a mesh\n"), whole.substr(0, whole.size() / 3),
          std::string()}) {
      write_text(bad, content);
      const Outcome outcome = check(workspace, text);
      EXPECT_EQ(outcome.exit_code, 1);
      // file, line and what it is about
      EXPECT_NE(outcome.err.find("checked.prm:5: error"), std::string::npos)
          << outcome.err;
      EXPECT_NE(outcome.err.find("bad.msh"), std::string::npos) << outcome.err;
      EXPECT_EQ(outcome.err.find("group"), std::string::npos) << outcome.err;
    }
    write_text(workspace.path() / "bad.geo", "Point(1) = {0, 0;\n");
    std::string script = text;
    script.replace(script.find("bad.msh"), 7, "bad.geo");
    const Outcome refused = check(workspace, script);
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_NE(refused.err.find("line 1: syntax error"), std::string::npos)
        << refused.err;
    fs::remove(bad);
    const Outcome missing = check(workspace, text);
    EXPECT_EQ(missing.exit_code, 1);
    EXPECT_NE(missing.err.find("there is no file"), std::string::npos)
        << missing.err;
  }

  TEST(Meshes, ScriptsOnlyDescribeGeometry)
  {
    const Workspace workspace;
    const std::string acts = (workspace.path() / "acted").string();
    write_text(workspace.path() / "beam.geo", "Point(1) = {0, 0, 0, 1};\n"
                                              "SystemCall \"touch " +
                                                  acts +
                                                  "\";\n"
                                                  "Printf(\"written\") > \"" +
                                                  acts +
                                                  "\";\n"
                                                  "Include \"more.geo\";\n");
    write_text(workspace.path() / "more.geo",
               "Field[1] = ExternalProcess;\n"
               "Field[1].CommandLine = \"touch " +
                   acts +
                   "\";\n"
                   "Save \"" +
                   acts + "\";\n");
    write_text(workspace.path() / "beam.geo.opt",
               "SystemCall \"touch " + acts + "\";\n");
    write_text(workspace.path() / "beam.prm",
               "set dimension = 2\nsubsection Mesh\n  set type = file\n"
               "  set file = beam.geo\nend\n"
               "subsection Material: m\n  set Young modulus = 1\n"
               "  set Poisson ratio = 0.3\n  set density = 1\nend\n"
               "subsection Interface: all\n  set law = rigid\nend\n"
               "subsection Time\n  set end = 1\n  set step = 1\nend\n");
    const auto before = files_below(workspace.path());
    for (const char *option : {"--check", "--force"}) {
      const Outcome outcome = nsfd(workspace, {"beam.prm", option});
      EXPECT_EQ(outcome.exit_code, 1);
      for (const char *part :
           {"beam.prm:4: error: `beam.geo`: line 2: `SystemCall` runs a "
            "command",
            "line 3: `Printf`", "line 1 of `more.geo`: a field of type",
            "line 2 of `more.geo`: the option `CommandLine`",
            "line 3 of `more.geo`: `Save` writes a file"})
        EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\n"
                                                             << outcome.err;
      EXPECT_EQ(files_below(workspace.path()), before);
    }
  }

  TEST(Meshes, GrainBoundariesCarryTheLaw)
  {
    const Workspace workspace;
    const std::string text =
        "# grains - pulled apart along the boundaries of grains.\n"
        "subsection Mesh\n"
        "  set type         = voronoi\n"
        "  set upper corner = 1 mm, 1 mm\n"
        "  set grains       = 6\n"
        "  set element size = 0.1 mm\nend\n"
        "subsection Material: bulk\n"
        "  set Young modulus = 200 GPa\n"
        "  set Poisson ratio = 0.3\n"
        "  set density       = 7800 kg/m^3\nend\n"
        "subsection Interface: boundaries\n"
        "  set where     = grain boundaries\n"
        "  set law       = camacho-ortiz\n"
        "  set strength  = 300 MPa\n"
        "  set toughness = 50 J/m^2\n"
        "  set intact faces = bonded\nend\n"
        "subsection Interface: inside\n"
        "  set law = bonded\nend\n"
        "subsection Boundary: right\n"
        "  set velocity x = 20 m/s\nend\n"
        "subsection Boundary: left\n"
        "  set velocity x = -20 m/s\nend\n"
        "subsection Time\n"
        "  set end  = 0.5 us\n"
        "  set step = 0.5 courant\nend\n";
    const Result result = run_text(workspace, "grains", text);
    ASSERT_TRUE(result.completed()) << result.description();
    EXPECT_GT(result.dissipated("damage"), 0.);
    EXPECT_GE(result.number("fragments"), 2);
    // nothing breaks inside a grain
    EXPECT_LE(result.number("fragments"), 6);
  }
} // namespace end_to_end::test_meshes
