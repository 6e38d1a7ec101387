#include "compare.h"

#include <gtest/gtest.h>

#include <string>

// `nsfd mesh`: the bias, sizes and angles of the mesh of a scene; and scenes on
// isotropic meshes.

namespace end_to_end::test_mesh_command
{
  namespace fs = std::filesystem;

  namespace
  {
    std::string plate(const std::string &mesh)
    {
      return "# plate - a plate that is pulled until it breaks.\n"
             "set plane = strain\n"
             "subsection Mesh\n" +
             mesh +
             "end\n"
             "subsection Material: glass\n"
             "  set Young modulus = if(x < 10 mm, 32 GPa, 34 GPa)\n"
             "  set Poisson ratio = 0.2\n"
             "  set density       = 2450 kg/m^3\nend\n"
             "subsection Interface: all\n"
             "  set law       = camacho-ortiz\n"
             "  set strength  = 6 MPa\n"
             "  set toughness = 3 J/m^2\nend\n"
             "subsection Boundary: top\n  set velocity y = 1 m/s\nend\n"
             "subsection Boundary: bottom\n  set velocity y = -1 m/s\nend\n"
             "subsection Time\n  set end = 4 us\n  set scheme = explicit\n"
             "  set step = auto\nend\n";
    }

    const std::string isotropic = "  set type         = isotropic\n"
                                  "  set upper corner = 20 mm, 10 mm\n"
                                  "  set cells        = 3000\n";

    Outcome look(const Workspace &workspace, const std::string &mesh,
                 std::vector<std::string> words = {})
    {
      write_text(workspace.path() / "plate.prm", plate(mesh));
      words.insert(words.begin(), {"mesh", "plate.prm"});
      return nsfd(workspace, words);
    }

    void expect_text(const std::string &text, const std::string &part)
    {
      EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
    }
  } // namespace

  TEST(MeshCommand, SaysWhatTheMeshDoesToCracks)
  {
    const Workspace workspace;
    // 28 spacings across: over fewer, ends count for more
    const Outcome outcome =
        look(workspace, isotropic, {"--set", "Mesh/cells=30000"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const char *part : {"path ratio", "by direction", "angles",
                             "triangles before they are cut",
                             "it is stable up "
                             "to",
                             "in output/mesh_plate: mesh.json, rose.svg"})
      expect_text(outcome.out, part);
    const fs::path folder = workspace.path() / "output" / "mesh_plate";
    const auto found = nlohmann::json::parse(read_text(folder / "mesh.json"));
    EXPECT_LE(found["path_ratio"]["mean"], 1.02);
    EXPECT_EQ(found["path_ratio"]["directions"].size(), 24u);
    expect_text(read_text(folder / "rose.svg"), "<svg");
    // not over what is there
    EXPECT_EQ(look(workspace, isotropic).exit_code, 1);
    EXPECT_EQ(look(workspace, isotropic, {"--force"}).exit_code, 0);
  }

  TEST(MeshCommand, WritesNothingIfItIsNotAsked)
  {
    const Workspace workspace;
    const Outcome outcome = look(workspace, isotropic, {"--check"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    expect_text(outcome.out, "path ratio");
    EXPECT_EQ(files_below(workspace.path()).size(), 1u);
    EXPECT_EQ(nsfd(workspace, {"mesh"}).exit_code, 2);
    EXPECT_EQ(nsfd(workspace, {"mesh", "plate.prm", "--vary", "a=1"}).exit_code,
              2);
  }

  TEST(MeshCommand, NamesEveryError)
  {
    const Workspace workspace;
    const Outcome outcome =
        look(workspace, "  set type = isotropic\n  set size = 1 kg\n"
                        "  set lines = a: [0, 0]\n  set split = six\n");
    EXPECT_EQ(outcome.exit_code, 1);
    for (const char *part : {"upper corner", "size", "lines", "split",
                             "4 errors, nothing was run"})
      expect_text(outcome.err, part);
  }

  // A mesh file never runs a command, here neither.
  TEST(MeshCommand, ScriptsOfGmshAreFiltered)
  {
    const Workspace workspace;
    write_text(workspace.path() / "bad.geo",
               "SystemCall \"touch made\";\nPoint(1) = {0, 0, 0, 1};\n");
    const Outcome outcome = look(workspace, "  set type = isotropic\n"
                                            "  set file = bad.geo\n"
                                            "  set size = 1 mm\n");
    EXPECT_EQ(outcome.exit_code, 1);
    expect_text(outcome.err, "`SystemCall` runs a command");
    EXPECT_FALSE(fs::exists(workspace.path() / "made"));
  }

  // All three ways of motion on one mesh: implicit, explicit and at rest.
  TEST(MeshCommand, ScenesRunOnIsotropicMeshes)
  {
    const Workspace workspace;
    const auto file = workspace.path() / "plate.prm";
    write_text(file, plate(isotropic));
    const std::string rows[][2] = {
        {"Time/scheme=explicit", "Time/step=auto"},
        {"Time/scheme=moreau-jean", "Time/step=1 courant"}};
    for (const auto &row : rows) {
      const Result result =
          good_run(workspace, row[0].substr(12),
                   {file, {row[0], row[1], "Mesh/cells=600"}});
      EXPECT_TRUE(result.completed()) << row[0];
    }
  }
} // namespace end_to_end::test_mesh_command
