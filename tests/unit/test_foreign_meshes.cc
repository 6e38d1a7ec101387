// Meshes that other programs wrote: tests/meshes/README.md says which, and how.

#include "foreign_meshes.h"

#include "mesh/neper_sections.h"

#include <cmath>
#include <vector>

using namespace nsfd;
using namespace nsfd::test;

namespace test_foreign_meshes
{
  constexpr double tolerance = 1e-9; // some files have eight digits

  /** The plate of tests/meshes/plate.geo: 2 x 1, seam at x = 1. */
  void expect_halves(const BuiltMesh<2> &plate, const std::string &first,
                     const std::string &second)
  {
    ASSERT_TRUE(plate.triangulation);
    EXPECT_NEAR(plate.volume("all"), 2., tolerance);
    EXPECT_NEAR(plate.volume(first), 1., tolerance);
    EXPECT_NEAR(plate.volume(second), 1., tolerance);
  }

  void expect_curves(const BuiltMesh<2> &plate,
                     const std::vector<std::string> &names)
  {
    EXPECT_NEAR(plate.boundary_area(names[0]), 1., tolerance);
    EXPECT_NEAR(plate.boundary_area(names[1]), 1., tolerance);
    EXPECT_NEAR(plate.inner_area(names[2]), 1., tolerance);
    EXPECT_NEAR(plate.inner_area(names[3]), .5, tolerance);
  }

  class VtkTest : public testing::TestWithParam<std::string>
  {
  };

  TEST_P(VtkTest, GroupsAreNumbersOfCellData)
  {
    const BuiltMesh<2> plate(mesh_scene(2, mesh_of_tests(GetParam())));
    expect_halves(plate, "1", "2");
    expect_curves(plate, {"11", "12", "13", "14"});
  }

  INSTANTIATE_TEST_SUITE_P(
      Files, VtkTest,
      testing::Values("plate_gmsh.vtk", "plate_gmsh_binary.vtk",
                      "plate_meshio.vtk", "plate_meshio.vtu",
                      "plate_vtk_ascii.vtk", "plate_vtk_binary.vtk",
                      "plate_vtk_ascii.vtu", "plate_vtk_inline.vtu",
                      "plate_vtk_base64.vtu", "plate_vtk_raw.vtu"),
      [](const auto &info) { return file_as_name(info); });

  TEST(ForeignMeshes, VtkHasFieldsAndOrientations)
  {
    for (const char *name : {"plate_vtk_binary.vtk", "plate_vtk_ascii.vtk",
                             "plate_vtk_raw.vtu", "plate_vtk_inline.vtu"}) {
      const BuiltMesh<2> plate(mesh_scene(2, mesh_of_tests(name)));
      const NamedMesh &mesh = plate.named();
      ASSERT_EQ(mesh.fields.count("quality"), 1u) << name;
      ASSERT_EQ(mesh.cell_data.count("orientation"), 1u) << name;
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const unsigned int set = mesh.cells.set[c];
        const int number = mesh.groups[mesh.sets[set].front()].number;
        EXPECT_EQ(mesh.fields.at("quality")[c], .5 * number) << name;
        EXPECT_EQ(mesh.fields.at("phase")[c], 100. + number) << name;
        EXPECT_EQ(mesh.cell_data.at("orientation")[set][0], 10. * number);
        EXPECT_EQ(mesh.cell_data.at("orientation")[set][2], 30.);
      }
    }
  }

  TEST(ForeignMeshes, OtherCellDataAreGroupsIfSaid)
  {
    const std::string more = "set group data = phase";
    expect_halves(
        BuiltMesh<2>(mesh_scene(2, mesh_of_tests("plate_vtk_raw.vtu", more))),
        "101", "102");
    expect_part(
        errors_of(mesh_scene(
            2, mesh_of_tests("plate_vtk_raw.vtu", "set group data = grain"))),
        "it has no cell data `grain` of one component for `group "
        "data`; it has MaterialID, phase, quality");
    expect_part(errors_of(mesh_scene(2, mesh_of_tests("plate_vtk_raw.vtu",
                                                      "set group data = "
                                                      "quality"))),
                "`group data` = quality: the value 5.5 of cell 4 is no whole "
                "number");
    expect_part(
        errors_of(mesh_scene(2, mesh_of_tests("plate_22_ascii.msh", more))),
        "only files of VTK number their groups by cell data");
  }

  TEST(ForeignMeshes, AbaqusDecksOfGmshAndMeshio)
  {
    const BuiltMesh<2> of_gmsh(mesh_scene(2, mesh_of_tests("plate_gmsh.inp")));
    expect_halves(of_gmsh, "steel", "glue");
    expect_curves(of_gmsh, {"left_end", "right_end", "seam", "crack"});
    const BuiltMesh<2> of_meshio(
        mesh_scene(2, mesh_of_tests("plate_meshio.inp")));
    EXPECT_NEAR(of_meshio.volume("all"), 2., tolerance);
    ASSERT_FALSE(of_meshio.named().notes.empty());
    expect_part(of_meshio.named().notes[0], "86 elements of the type R3D3");
  }

  // Four squares of side 1, moved by 5 along x and turned by 90 degrees: what
  // was below is at x = 5, what was above at x = 3.
  TEST(ForeignMeshes, AbaqusPartsAreAtTheirPlaces)
  {
    const BuiltMesh<2> plate(mesh_scene(2, mesh_of_tests("plate_cae.inp")));
    ASSERT_TRUE(plate.triangulation);
    EXPECT_NEAR(plate.volume("All of it"), 4., tolerance);
    EXPECT_NEAR(plate.volume("Lower"), 2., tolerance);
    EXPECT_NEAR(plate.volume("Upper"), 2., tolerance);
    EXPECT_NEAR(plate.volume("Weak"), 1., tolerance);
    EXPECT_NEAR(plate.boundary_area("Grip"), 2., tolerance);
    EXPECT_NEAR(plate.boundary_area("Loaded"), 2., tolerance);
    for (const auto &cell : plate.triangulation->active_cell_iterators())
      for (const unsigned int f : cell->face_indices()) {
        const auto in = [&](const char *group) {
          return plate.groups->holds_boundary_face(BuiltMesh<2>::where(group),
                                                   cell, f);
        };
        const double x = cell->face(f)->center()[0];
        EXPECT_TRUE(!in("Grip") || std::abs(x - 5.) < tolerance);
        EXPECT_TRUE(!in("Loaded") || std::abs(x - 3.) < tolerance);
      }
    // what a surface leaves behind is no group
    EXPECT_EQ(errors_of(mesh_scene(2, mesh_of_tests("plate_cae.inp"),
                                   "subsection Boundary: b\n"
                                   "  set where = _Loaded_S3\nend\n"))
                  .empty(),
              false);
  }

  // A line that ends with a comma goes on; middle nodes come after the corners.
  TEST(ForeignMeshes, AbaqusElementsOfSecondOrder)
  {
    const TemporaryFile file("second.inp",
                             "*Node\n1, 0., 0.\n2, 2., 0.\n3, 2., 2.\n"
                             "4, 0., 2.\n5, 1., 0.\n6, 2., 1.\n7, 1., 2.\n"
                             "8, 0., 1.\n*Element, type=CPE8R, elset=all-1\n"
                             "1, 1, 2, 3, 4, 5,\n6, 7, 8\n");
    const BuiltMesh<2> mesh(mesh_scene(2, file.entries()));
    ASSERT_TRUE(mesh.triangulation);
    EXPECT_NEAR(mesh.volume("all-1"), 4., tolerance);
    ASSERT_EQ(mesh.named().notes.size(), 1u);
    expect_part(mesh.named().notes[0], "1 cells are of higher order");
  }

  TEST(ForeignMeshes, AbaqusInstancesHaveNamesOfTheirOwn)
  {
    std::string deck = content_of_test("plate_cae.inp");
    deck = with(deck, "*End Instance\n",
                "*End Instance\n*Instance, name=Plate-2, part=Plate\n"
                "10., 0.\n*End Instance\n");
    const TemporaryFile file("two.inp", deck);
    const BuiltMesh<2> two(mesh_scene(2, file.entries()));
    ASSERT_TRUE(two.triangulation);
    EXPECT_NEAR(two.volume("all"), 8., tolerance);
    EXPECT_NEAR(two.volume("Plate-1"), 4., tolerance);
    EXPECT_NEAR(two.volume("Plate-2.Lower"), 2., tolerance);
    EXPECT_NEAR(two.volume("Weak"), 1., tolerance); // of the assembly
    EXPECT_NEAR(two.boundary_area("Grip"), 2., tolerance);
  }

  TEST(ForeignMeshes, ExodusOfVtkAndMeshio)
  {
    // a block for each material, with vertices of their own
    const BuiltMesh<2> plate(mesh_scene(
        2, mesh_of_tests("plate_vtk.e", "set merge vertices = true")));
    expect_halves(plate, "5", "87");
    const NamedMesh &mesh = plate.named();
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
      const int block =
          mesh.groups[mesh.sets[mesh.cells.set[c]].front()].number;
      EXPECT_EQ(mesh.fields.at("quality")[c], block == 5 ? .5 : 1.);
    }
    const BuiltMesh<3> block(mesh_scene(3, mesh_of_tests("block_meshio.e")));
    ASSERT_TRUE(block.triangulation);
    EXPECT_NEAR(block.volume("all"), 2., tolerance);
    EXPECT_NEAR(block.boundary_area("ground"), 1., tolerance);
    EXPECT_NEAR(block.boundary_area("lid"), 1., tolerance);
  }

  // Sides are faces of their cells: none is left out, and none is twice.
  TEST(ForeignMeshes, ExodusSidesOfAllShapes)
  {
    const double area =
        6. + (1.5 + std::sqrt(3.) / 2.) + (1. + 2. + std::sqrt(2.));
    for (const char *name : {"block_sides.e", "block_sides_cdf5.exo"}) {
      const BuiltMesh<3> bodies(
          mesh_scene(3, mesh_of_tests(name, "set split simplices = true")));
      ASSERT_TRUE(bodies.triangulation) << name;
      EXPECT_NEAR(bodies.volume("cube"), 1., tolerance) << name;
      EXPECT_NEAR(bodies.volume("20"), 1. / 6., tolerance) << name;
      EXPECT_NEAR(bodies.volume("30"), .5, tolerance) << name;
      EXPECT_NEAR(bodies.boundary_area("all"), area, tolerance) << name;
      EXPECT_NEAR(bodies.boundary_area("outside"), area, tolerance) << name;
      EXPECT_TRUE(bodies.named().notes.empty()) << bodies.named().notes[0];
      // at the last of two times
      const std::vector<double> damage = {.25, .5, .75};
      EXPECT_EQ(bodies.named().fields.at("damage"), damage) << name;
    }
  }

  TEST(ForeignMeshes, NeperInThePlane)
  {
    const BuiltMesh<2> grains(mesh_scene(2, mesh_of_tests("grains_neper.msh")));
    ASSERT_TRUE(grains.triangulation);
    EXPECT_NEAR(grains.volume("face1"), 2., tolerance);
    EXPECT_NEAR(grains.volume("face2"), 2., tolerance);
    EXPECT_NEAR(grains.inner_area("edge7"), 2., tolerance);
    Where between;
    between.kind = Where::Kind::between_groups;
    EXPECT_NEAR(grains.inner_area(between), 2., tolerance);
    for (const char *side : {"x0", "x1", "y0", "y1", "periodic x0",
                             "periodic x1", "periodic y0", "periodic y1"})
      EXPECT_NEAR(grains.boundary_area(side), 2., tolerance) << side;
    const NamedMesh &mesh = grains.named();
    ASSERT_EQ(mesh.cell_data.count("orientation"), 1u);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
      const unsigned int set = mesh.cells.set[c];
      const bool is_first = mesh.groups[mesh.sets[set].front()].name == "face1";
      EXPECT_EQ(mesh.fields.at("group")[c], is_first ? 1. : 3.);
      // tan(15 degrees) about x, tan(22.5 degrees) about z; 12 digits
      const auto &angles = mesh.cell_data.at("orientation")[set];
      EXPECT_NEAR(angles[0], is_first ? 0. : 45., 1e-9);
      EXPECT_NEAR(angles[1], is_first ? 30. : 0., 1e-9);
      EXPECT_NEAR(angles[2], 0., 1e-9);
    }
    EXPECT_EQ(std::count_if(mesh.groups.begin(), mesh.groups.end(),
                            [](const auto &g) { return g.name == "x0y0"; }),
              0);
  }

  TEST(ForeignMeshes, NeperInSpaceOfSecondOrder)
  {
    const BuiltMesh<3> block(mesh_scene(3, mesh_of_tests("block_neper.msh")));
    ASSERT_TRUE(block.triangulation);
    EXPECT_NEAR(block.volume("poly1"), 1., tolerance);
    EXPECT_NEAR(block.volume("poly2"), 1., tolerance);
    EXPECT_NEAR(block.boundary_area("z1"), 2., tolerance);
    EXPECT_NEAR(block.boundary_area("x0"), 1., tolerance);
    const NamedMesh &mesh = block.named();
    for (std::size_t c = 0; c < mesh.cells.size(); ++c)
      EXPECT_NEAR(mesh.cell_data.at("orientation")[mesh.cells.set[c]][0],
                  10. * double(mesh.cells.numbers[c]), 1e-9);
  }

  // The table of Neper's manual, "Orientation Convention": 30 degrees about x.
  TEST(ForeignMeshes, OrientationsOfNeperAreBungesAngles)
  {
    const double c = std::sqrt(.75), half = std::acos(-1.) / 12.;
    const std::vector<std::pair<std::string, std::vector<double>>> same = {
        {"rodrigues", {std::tan(half), 0., 0.}},
        {"rodrigues:passive", {std::tan(half), 0., 0.}},
        {"rodrigues:active", {-std::tan(half), 0., 0.}},
        {"euler-bunge:passive", {0., 30., 0.}},
        {"euler-kocks", {270., 30., 90.}},
        {"euler-roe", {270., 30., 90.}},
        {"rotmat", {1., 0., 0., 0., c, .5, 0., -.5, c}},
        {"rotmat:active", {1., 0., 0., 0., c, -.5, 0., .5, c}},
        {"axis-angle", {1., 0., 0., 30.}},
        {"quaternion", {std::cos(half), std::sin(half), 0., 0.}}};
    for (const auto &[name, values] : same) {
      std::array<double, 3> angles{};
      ASSERT_TRUE(bunge_angles(name, values, angles)) << name;
      EXPECT_NEAR(std::remainder(angles[0], 360.), 0., 1e-12) << name;
      EXPECT_NEAR(angles[1], 30., 1e-12) << name;
      EXPECT_NEAR(std::remainder(angles[2], 360.), 0., 1e-12) << name;
    }
    // and there and back again
    std::array<double, 3> angles{};
    ASSERT_TRUE(bunge_angles("euler-bunge", {100., 50., -70.}, angles));
    EXPECT_NEAR(angles[0], 100., 1e-12);
    EXPECT_NEAR(angles[1], 50., 1e-12);
    EXPECT_NEAR(angles[2], -70., 1e-12);
    EXPECT_FALSE(bunge_angles("euler-bunge", {1., 2.}, angles));
    EXPECT_FALSE(bunge_angles("homochoric", {1., 2., 3.}, angles));
  }
} // namespace test_foreign_meshes
