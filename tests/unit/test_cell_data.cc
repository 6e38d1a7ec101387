// Cell data of a mesh as names in formulas.

#include "foreign_meshes.h"

#include "mesh/cell_fields.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

using namespace nsfd;
using namespace nsfd::test;

namespace test_cell_data
{
  constexpr double tolerance = 1e-9;

  /** plate_vtk_raw.vtu: phase 101 and quality 0.5 for x < 1, else 102 and 1. */
  const std::string plate = mesh_of_tests("plate_vtk_raw.vtu");

  std::string material(const std::string &entries)
  {
    return "subsection Material: other\n  set Young modulus = 2\n"
           "  set Poisson ratio = 0.3\n  set density = 1\n" +
           entries + "end\n";
  }

  std::string with_interface(const std::string &entries)
  {
    return "subsection Interface: cohesive\n  set law = camacho-ortiz\n"
           "  set strength = 3 MPa\n  set toughness = 4 J/m^2\n" +
           entries + "end\n";
  }

  TEST(CellData, ConditionsHoldInCellsAndOnBothSidesOfFaces)
  {
    const BuiltMesh<2> mesh(
        mesh_scene(2, plate,
                   material("  set where = phase == 102 && x > 0.5\n") +
                       with_interface("  set where = phase == 102\n")));
    ASSERT_TRUE(mesh.input);
    double volume = 0.;
    for (const auto &cell : mesh.triangulation->active_cell_iterators())
      if (mesh.groups->holds_cell(mesh.input->materials[1].where, cell))
        volume += cell->measure();
    EXPECT_NEAR(volume, 1., tolerance);
    // as the faces of a group of cells: not those of the seam
    const double of_group = mesh.inner_area("2");
    EXPECT_GT(of_group, 1.);
    EXPECT_NEAR(mesh.inner_area(mesh.input->interfaces[0].where), of_group,
                tolerance);
  }

  TEST(CellData, ValuesOnFacesAreTheMeanOfBothSides)
  {
    const BuiltMesh<2> mesh(mesh_scene(
        2, plate,
        material("  set initial velocity x = 3 m/s * quality + x * 0 1/s\n")));
    ASSERT_TRUE(mesh.input);
    const Expression &velocity = mesh.input->materials[1].initial_velocity[0];
    EXPECT_TRUE(velocity.depends_on_position());
    EXPECT_FALSE(velocity.is_constant());
    EXPECT_NEAR(velocity(.3, .7, 0.), 1.5, tolerance);
    EXPECT_NEAR(velocity(1.7, .2, 0.), 3., tolerance);
    // in the middle of an edge of the seam, whose vertices are at k / 4
    EXPECT_NEAR(velocity(1., .125, 0.), 2.25, tolerance);
    // at a corner of the plate, and outside
    EXPECT_NEAR(velocity(0., 0., 0.), 1.5, tolerance);
    EXPECT_TRUE(std::isnan(velocity(2.1, .5, 0.)));
  }

  // Of Gmsh, for the first twenty triangles of 86 only.
  TEST(CellData, CellsWithoutThemAreNamed)
  {
    std::string text = content_of_test("plate_22_ascii.msh");
    text += "$ElementData\n1\n\"yield share\"\n1\n0\n3\n0\n1\n20\n";
    for (unsigned int k = 0; k < 20; ++k)
      text += std::to_string(15 + k) + " 1.5\n"; // behind 14 curves
    text += "$EndElementData\n";
    const TemporaryFile file("some.msh", text);
    const BuiltMesh<2> mesh(mesh_scene(2, file.entries()));
    ASSERT_TRUE(mesh.input);
    const auto &values = mesh.named().fields.at("yield_share");
    ASSERT_EQ(values.size(), 86u);
    EXPECT_EQ(std::count(values.begin(), values.end(), 1.5), 20);
    EXPECT_EQ(std::count_if(values.begin(), values.end(),
                            [](const double v) { return std::isnan(v); }),
              66);
    // a condition is no condition there, instead of false
    const BuiltMesh<2> block(mesh_scene(
        2, file.entries(), material("  set where = yield_share > 1\n")));
    ASSERT_TRUE(block.input);
    const Expression &where = block.input->materials[1].where.condition;
    unsigned int n_true = 0, n_unknown = 0;
    for (const auto &cell : block.triangulation->active_cell_iterators()) {
      const double value = where.at(cell->center());
      n_true += value == 1.;
      n_unknown += std::isnan(value);
    }
    EXPECT_EQ(n_true, 20u);
    EXPECT_EQ(n_unknown, 66u);
  }

  TEST(CellData, MaterialsAreGradedByThem)
  {
    const std::string text =
        "subsection Mesh\n" + plate +
        "end\nsubsection Material: all\n"
        "  set Young modulus = (200 - 100 * (phase - 101)) * 1 GPa\n"
        "  set Poisson ratio = 0.3\n  set density = 1000 kg/m^3 * quality\n"
        "end\nsubsection Interface: all\n  set law = rigid\nend\n"
        "subsection Time\n  set end = 1\n  set step = 1\nend\n";
    const BuiltMesh<2> mesh(text);
    ASSERT_TRUE(mesh.input);
    ASSERT_TRUE(mesh.input->materials[0].graded);
    const GradedInput &graded = *mesh.input->materials[0].graded;
    EXPECT_NEAR(graded.young(.5, .5, 0.), 2e11, 1.);
    EXPECT_NEAR(graded.young(1.5, .5, 0.), 1e11, 1.);
    EXPECT_NEAR(graded.density(.5, .4, 0.), 500., 1e-6);
  }

  TEST(CellData, WhatCannotBeIsSaid)
  {
    const auto errors = [](const std::string &mesh_lines,
                           const std::string &more) {
      return errors_of(mesh_scene(2, mesh_lines, more));
    };
    expect_part(errors(plate, material("  set where = phase\n")),
                "where = phase: these are cell data, no group");
    expect_part(errors(plate, material("  set where = qualty > 1\n")),
                "did you mean `quality`?");
    expect_part(errors(plate + "set distortion = 0.1\n",
                       material("  set where = phase == 101\n")),
                "`phase`: cell data belong to cells as the file has them, and "
                "`distortion` moves their corners");
    const std::string number =
        "subsection Solver\n  set tolerance = 1e-8 * quality\nend\n";
    expect_part(errors(plate, number),
                "`quality` cannot stand here: a number is expected, and cell "
                "data differ from place to place");
    // a constant of that name is what formulas take
    InputErrors found;
    read_scene_text("subsection Constants\n  set quality = 2\nend\n" +
                        mesh_scene(2, plate),
                    "test.prm", {}, found);
    EXPECT_FALSE(found.has_errors()) << found.report();
    expect_part(found.report(), "formulas take `quality` for the entry of "
                                "section Constants");
  }

  TEST(CellData, NamesAreThoseOfFormulas)
  {
    EXPECT_EQ(field_name("gmsh:physical"), "gmsh_physical");
    EXPECT_EQ(field_name("grain size"), "grain_size");
    // a length, a variable, a function, a number
    EXPECT_EQ(field_name("mm"), "cell_mm");
    EXPECT_EQ(field_name("t"), "cell_t");
    EXPECT_EQ(field_name("max"), "cell_max");
    EXPECT_EQ(field_name("2nd"), "cell_2nd");
    NamedMesh mesh;
    add_field(mesh, "a b", {1.});
    add_field(mesh, "a:b", {2.});
    EXPECT_EQ(mesh.fields.at("a_b"), std::vector<double>{1.});
    ASSERT_EQ(mesh.notes.size(), 2u);
    expect_part(mesh.notes[1], "`a:b` are left out");
  }

  /** A mesh of one cell of each shape and its field `v`, for the search. */
  NamedMesh one_cell(const unsigned int dimension,
                     const std::vector<double> &coordinates)
  {
    NamedMesh mesh;
    mesh.dimension = dimension;
    mesh.coordinates = coordinates;
    std::vector<unsigned int> corners;
    for (unsigned int v = 0; v < coordinates.size() / 3; ++v)
      corners.push_back(v);
    mesh.cells.add(corners, 0);
    mesh.fields["v"] = {7.};
    return mesh;
  }

  bool holds(const NamedMesh &mesh, const double x, const double y,
             const double z)
  {
    const CellFields fields(std::make_shared<NamedMesh>(mesh));
    std::vector<std::size_t> cells;
    fields.find(x, y, z, cells);
    return !cells.empty() && fields.value(0, cells[0]) == 7.;
  }

  TEST(CellData, EveryShapeIsFound)
  {
    // skew by a factor, and small against its place
    const double s = 1e-6, o = 1.;
    const auto at = [&](std::vector<double> x) {
      for (double &value : x)
        value = o + s * value;
      return x;
    };
    const auto flat = [&](std::vector<double> x) {
      x = at(x);
      for (std::size_t i = 2; i < x.size(); i += 3)
        x[i] = 0.;
      return x;
    };
    const auto in = [&](const NamedMesh &mesh, const double x, const double y,
                        const double z) {
      return holds(mesh, o + s * x, o + s * y, o + s * z);
    };
    const NamedMesh triangle = one_cell(2, flat({0, 0, 0, 2, 0, 0, 0, 1, 0}));
    EXPECT_TRUE(in(triangle, .9, .5, 0.));
    EXPECT_TRUE(in(triangle, 1., .5, 0.)); // on its edge
    EXPECT_FALSE(in(triangle, 1.1, .5, 0.));
    const NamedMesh quad =
        one_cell(2, flat({0, 0, 0, 2, 0, 0, 0, 1, 0, 1, 1, 0}));
    EXPECT_TRUE(in(quad, 1.4, .5, 0.));
    EXPECT_FALSE(in(quad, 1.6, .5, 0.));
    const NamedMesh tetrahedron =
        one_cell(3, at({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}));
    EXPECT_TRUE(in(tetrahedron, .3, .3, .3));
    EXPECT_FALSE(in(tetrahedron, .4, .4, .4));
    const NamedMesh prism =
        one_cell(3, at({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 2, 1, 0, 2, 0, 1, 2}));
    EXPECT_TRUE(in(prism, .4, .4, 1.9));
    EXPECT_FALSE(in(prism, .6, .6, 1.));
    EXPECT_FALSE(in(prism, .4, .4, 2.1));
    // its upper face is twisted: at the middle it is 1.25 high
    const NamedMesh hex = one_cell(3, at({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0,
                                          0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 2}));
    EXPECT_TRUE(in(hex, .5, .5, 1.24));
    EXPECT_FALSE(in(hex, .5, .5, 1.26));
  }
} // namespace test_cell_data
