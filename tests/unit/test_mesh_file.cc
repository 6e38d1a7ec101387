// Meshes in files: the same plate and block through every format.

#include "named_mesh_scene.h"

#include <algorithm>
#include <array>
#include <cmath>

using namespace nsfd;
using namespace nsfd::test;

namespace test_mesh_file
{
  const std::string meshes = std::string(NSFD_SOURCE_DIR) + "/tests/meshes/";

  std::string from_file(const std::string &name, const std::string &more = "")
  {
    return "set type = file\nset file = " + meshes + name + "\n" + more;
  }

  /** tests/meshes/plate.geo: 2 mm x 1 mm, seam at x = 1, crack of 0.5. */
  void expect_plate(const BuiltMesh<2> &plate, const double unit,
                    const bool with_inner_curves = true)
  {
    ASSERT_TRUE(plate.triangulation);
    const double tolerance = 1e-12;
    EXPECT_NEAR(plate.volume("all"), 2. * unit * unit, tolerance * unit * unit);
    const std::string first = with_inner_curves ? "steel" : "1",
                      second = with_inner_curves ? "glue" : "2",
                      left = with_inner_curves ? "left end" : "11",
                      right = with_inner_curves ? "right end" : "12";
    EXPECT_NEAR(plate.volume(first), unit * unit, tolerance * unit * unit);
    EXPECT_NEAR(plate.volume(second), unit * unit, tolerance * unit * unit);
    EXPECT_NEAR(plate.boundary_area(left), unit, tolerance * unit);
    EXPECT_NEAR(plate.boundary_area(right), unit, tolerance * unit);
    EXPECT_EQ(plate.inner_area(left), 0.);
    if (!with_inner_curves)
      return;
    EXPECT_NEAR(plate.inner_area("seam"), unit, tolerance * unit);
    EXPECT_NEAR(plate.inner_area("crack"), .5 * unit, tolerance * unit);
    EXPECT_EQ(plate.boundary_area("crack"), 0.);
    // numbers mean the same
    EXPECT_NEAR(plate.volume("1"), unit * unit, tolerance * unit * unit);
    EXPECT_NEAR(plate.inner_area("13"), unit, tolerance * unit);
  }

  template <int dim>
  double boundary_area(const BuiltMesh<dim> &mesh)
  {
    return mesh.boundary_area("all");
  }

  class PlateTest : public testing::TestWithParam<std::string>
  {
  };

  TEST_P(PlateTest, AreasAndGroupsAreThoseOfTheDrawing)
  {
    expect_plate(BuiltMesh<2>(mesh_scene(
                     2, from_file(GetParam(), "set length unit = mm"))),
                 1e-3);
  }

  TEST_P(PlateTest, SurvivesSplitAndRefinement)
  {
    expect_plate(BuiltMesh<2>(mesh_scene(
                     2, from_file(GetParam(), "set refinements = 1"))),
                 1.);
    const BuiltMesh<2> split(mesh_scene(
        2, from_file(GetParam(),
                     "set split simplices = true\nset refinements = 1")));
    expect_plate(split, 1.);
    EXPECT_TRUE(split.triangulation->all_reference_cells_are_hyper_cube());
  }

  INSTANTIATE_TEST_SUITE_P(
      Formats, PlateTest,
      testing::Values("plate_22_ascii.msh", "plate_22_binary.msh",
                      "plate_41_ascii.msh", "plate_41_binary.msh",
                      "plate_quads.msh", "plate_second_order.msh",
                      "plate_2_partitions.msh", "plate.geo"),
      [](const auto &info) { return file_as_name(info); });

  /** Sorted, the numbers of vertices do not matter. */
  std::vector<std::array<double, 2>> places(const NamedMesh &mesh)
  {
    std::vector<std::array<double, 2>> result;
    for (std::size_t v = 0; v < mesh.n_vertices(); ++v)
      result.push_back(
          {{mesh.coordinates[3 * v], mesh.coordinates[3 * v + 1]}});
    std::sort(result.begin(), result.end());
    return result;
  }

  TEST(MeshFile, FourGmshFormatsAreTheSameMesh)
  {
    const BuiltMesh<2> first(mesh_scene(2, from_file("plate_41_binary.msh")));
    for (const char *name :
         {"plate_22_ascii.msh", "plate_22_binary.msh", "plate_41_ascii.msh"}) {
      const BuiltMesh<2> other(mesh_scene(2, from_file(name)));
      ASSERT_EQ(other.named().n_vertices(), first.named().n_vertices()) << name;
      EXPECT_EQ(other.named().cells.size(), first.named().cells.size()) << name;
      // text has 16 digits
      const auto a = places(first.named()), b = places(other.named());
      for (std::size_t v = 0; v < a.size(); ++v)
        for (unsigned int d = 0; d < 2; ++d)
          EXPECT_NEAR(a[v][d], b[v][d], 1e-15) << name;
    }
  }

  // A file without a type is a mesh all the same.
  TEST(MeshFile, TypeFollowsFromTheFile)
  {
    std::string text = from_file("plate_41_ascii.msh", "set length unit = mm");
    text.erase(0, text.find('\n') + 1);
    expect_plate(BuiltMesh<2>(mesh_scene(2, text)), 1e-3);
  }

  TEST(MeshFile, UcdAndVtkHaveNumbers)
  {
    expect_plate(BuiltMesh<2>(mesh_scene(
                     2, from_file("plate_ucd.inp", "set length unit = mm"))),
                 1e-3, false);
    expect_plate(BuiltMesh<2>(mesh_scene(
                     2, from_file("plate.vtk", "set length unit = mm"))),
                 1e-3, false);
  }

  TEST(MeshFile, SecondOrderElementsBecomeStraight)
  {
    const BuiltMesh<2> mesh(mesh_scene(2, from_file("plate_second_order.msh")));
    ASSERT_EQ(mesh.named().notes.size(), 1u);
    EXPECT_NE(mesh.named().notes[0].find("higher order"), std::string::npos);
  }

  TEST(MeshFile, BlocksOfHexes)
  {
    for (const char *name :
         {"block_hexes.msh", "block_hexes.inp", "block.geo"}) {
      const BuiltMesh<3> block(
          mesh_scene(3, from_file(name, "set refinements = 1")));
      ASSERT_TRUE(block.triangulation) << name;
      EXPECT_EQ(block.triangulation->n_global_active_cells(), 128u) << name;
      EXPECT_NEAR(block.volume("all"), 2., 1e-11) << name;
      EXPECT_NEAR(block.volume("lower"), 1., 1e-11) << name;
      EXPECT_NEAR(block.volume("upper"), 1., 1e-11) << name;
      EXPECT_NEAR(block.boundary_area("ground"), 1., 1e-11) << name;
      EXPECT_NEAR(block.boundary_area("lid"), 1., 1e-11) << name;
      EXPECT_NEAR(block.inner_area("seam"), 1., 1e-11) << name;
      EXPECT_NEAR(boundary_area(block), 10., 1e-11) << name;
    }
  }

  TEST(MeshFile, StepIsReadInMetresAndMeshed)
  {
    const std::string size = "set element size = 1 mm\n";
    const BuiltMesh<3> tets(mesh_scene(3, from_file("box.step", size)));
    ASSERT_TRUE(tets.triangulation);
    EXPECT_NEAR(tets.volume("all"), 6e-9, 1e-15);
    EXPECT_NEAR(boundary_area(tets), 22e-6, 1e-12);
    // without physical groups, the faces of the body have numbers
    double sum = 0.;
    for (int face = 1; face <= 6; ++face)
      sum += tets.boundary_area(std::to_string(face));
    EXPECT_NEAR(sum, 22e-6, 1e-12);

    const BuiltMesh<3> hexes(
        mesh_scene(3, from_file("box.step", size + "set cell shape = hexes")));
    ASSERT_TRUE(hexes.triangulation);
    EXPECT_TRUE(hexes.triangulation->all_reference_cells_are_hyper_cube());
    EXPECT_NEAR(hexes.volume("all"), 6e-9, 1e-15);

    const BuiltMesh<3> split(mesh_scene(
        3, from_file("box.step", size + "set split simplices = true")));
    ASSERT_TRUE(split.triangulation);
    EXPECT_EQ(split.triangulation->n_global_active_cells(),
              4 * tets.triangulation->n_global_active_cells());
    EXPECT_NEAR(split.volume("all"), 6e-9, 1e-15);
  }

  TEST(MeshFile, GeometryTakesSizeAndShape)
  {
    const auto cells = [](const std::string &more) {
      return BuiltMesh<2>(mesh_scene(2, from_file("plate.geo", more)));
    };
    const BuiltMesh<2> coarse = cells("set element size = 0.5\n"),
                       fine = cells("set element size = 0.1\n"),
                       quads = cells("set element size = 0.05\n"
                                     "set cell shape = quads\n");
    // equilateral triangles of side h have the area sqrt(3)/4 h^2
    const double expected = 2. / (std::sqrt(3.) / 4. * .01);
    EXPECT_NEAR(double(fine.named().cells.size()), expected, .2 * expected);
    EXPECT_LT(coarse.named().cells.size(), 40u);
    EXPECT_TRUE(quads.triangulation->all_reference_cells_are_hyper_cube());
    EXPECT_NEAR(double(quads.named().cells.size()), 800., 320.);
    expect_plate(quads, 1.);
    const MeshReport report = mesh_report(*quads.triangulation);
    EXPECT_GT(report.smallest_angle, 30.);
    EXPECT_LT(report.largest_angle, 150.);
  }

  TEST(MeshFile, WrongEntriesAreNamed)
  {
    const auto errors = [](const unsigned int dimension,
                           const std::string &name, const std::string &more) {
      return errors_of(mesh_scene(dimension, from_file(name, more)));
    };
    const auto has = [](const std::string &text, const std::string &part) {
      return text.find(part) != std::string::npos;
    };
    EXPECT_TRUE(has(errors(2, "no_such.msh", ""), "there is no file"));
    EXPECT_TRUE(has(errors(2, "", ""), "is a folder"));
    const std::string size =
        errors(2, "plate_41_ascii.msh", "set element size = 1");
    EXPECT_TRUE(has(size, "test.prm:5: error: `element size` does not belong"))
        << size;
    EXPECT_TRUE(has(errors(2, "plate.geo", "set length unit = s"),
                    "length unit = s is no length"));
    EXPECT_TRUE(has(errors(3, "box.step", "set length unit = mm"),
                    "CAD files name their own unit"));
    EXPECT_TRUE(
        has(errors(2, "plate.geo", "set cell shape = hexes"), "cell shape"));
    EXPECT_TRUE(has(errors(2, "plate.geo",
                           "set element size = 1 um\n"
                           "set length unit = km"),
                    "cells of size"));
    EXPECT_TRUE(has(errors(3, "plate_41_ascii.msh", ""),
                    "it is a mesh of 2 dimensions, the scene has 3"));
    EXPECT_TRUE(has(errors(2, "block_hexes.msh", ""), "set dimension = 3"));
    EXPECT_TRUE(has(errors(2, "box.step", ""), "geometry of 3 dimensions"));
    EXPECT_TRUE(has(errors(2, "block_hexes.inp", ""), "set dimension = 3"));
  }

  TEST(MeshFile, ForeignAndTruncatedFilesAreRefused)
  {
    std::ifstream in(meshes + "plate_41_binary.msh", std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(in)), {});
    std::ifstream text_in(meshes + "plate_22_ascii.msh");
    const std::string text((std::istreambuf_iterator<char>(text_in)), {});
    const std::vector<std::pair<std::string, std::string>> files = {
        {"empty.msh", ""},
        {"picture.msh", "\x89PNG\r\n\x1a\n rubbish rubbish rubbish"},
        {"prose.msh", "Once upon a time there was a mesh.\nIt had no cells.\n"},
        {"half.msh", whole.substr(0, whole.size() / 2)},
        {"most.msh", whole.substr(0, whole.size() - 200)},
        {"half_text.msh", text.substr(0, text.size() / 2)},
        {"prose.step", "ISO-10303-21;\nnothing\n"},
        {"prose.inp", "*NODE\none, two, three\n"},
        {"ucd.inp", "3 4\n"},
        {"prose.vtk", "not a mesh\n"},
        {"empty.vtk", ""},
        {"prose.vtu", "not a mesh\n"}};
    for (const auto &[name, content] : files) {
      const TemporaryFile file(name, content);
      InputErrors errors;
      read_scene_text(mesh_scene(2, file.entries()), "test.prm", {}, errors);
      ASSERT_EQ(errors.n_errors(), 1u) << name << ": " << errors.report();
      const Diagnostic &error = errors.diagnostics().front();
      EXPECT_EQ(error.location.line, 4u) << name;
      EXPECT_NE(error.message.find(name), std::string::npos) << error.message;
    }
  }
} // namespace test_mesh_file
