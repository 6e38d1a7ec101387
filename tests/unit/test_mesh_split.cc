#include "make_scene.h"
#include "mesh_checks.h"
#include "named_mesh_scene.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

// `split = barycentric`: every triangle into six.

namespace mesh_checks::test_mesh_split
{
  namespace
  {
    const std::string plate =
        "set type = file\nset file = " + std::string(NSFD_SOURCE_DIR) +
        "/tests/meshes/plate_41_ascii.msh\n";

    std::string errors(const unsigned int dimension, const std::string &mesh)
    {
      return test::errors_of(
          test::mesh_scene(dimension, mesh + "set split = barycentric\n"));
    }
  } // namespace

  // A cell has the area of its triangle over six; inside each triangle the
  // three medians are new: of the legs a = 1 / sqrt(2), m = sqrt(5)/2 a, of the
  // hypotenuse 1/2.
  TEST(MeshSplit, CutsEveryTriangleAtItsMedians)
  {
    for (const unsigned int p : {1u, 3u}) {
      MeshInput mesh = cells_of_side_one("crossed triangles", 2, p);
      const auto before = report<2>(mesh);
      mesh.split_barycentric = true;
      const auto built = build<2>(scene_of(mesh));
      const auto after = mesh_report(*built);
      EXPECT_EQ(after.n_cells, 6 * before.n_cells);
      const double medians = .5 + 2. * std::sqrt(5.) / 2. * std::sqrt(.5);
      EXPECT_NEAR(after.inner_face_area,
                  before.inner_face_area + before.n_cells * medians,
                  1e-12 * after.inner_face_area);
      for (const auto &cell : built->active_cell_iterators())
        if (cell->is_locally_owned()) {
          EXPECT_NEAR(cell->measure(), 1. / 24., 1e-14);
        }
      // from a corner to the centroid: two thirds of a median
      EXPECT_NEAR(after.largest_edge, std::sqrt(5.) / 3. * std::sqrt(.5),
                  1e-15);
    }
    MeshInput mesh = cells_of_side_one("diagonal triangles", 2, 2);
    mesh.split_barycentric = true;
    mesh.refinements = 1;
    mesh.distortion = .2;
    const auto distorted = report<2>(mesh);
    EXPECT_EQ(distorted.n_cells, 6 * 32u);
    EXPECT_NEAR(distorted.volume, 4., 1e-13);
  }

  // A cell has the volume of its tetrahedron over twenty-four; inside of each,
  // the triangles from its centroid to the edges of its six medians of faces:
  // Kuhn's tetrahedra of a cube of side 1 have the volume 1/6.
  TEST(MeshSplit, CutsEveryTetrahedronInTwentyFour)
  {
    for (const unsigned int p : {1u, 2u}) {
      MeshInput mesh = cells_of_side_one("tetrahedra", 3, p);
      const auto before = report<3>(mesh);
      mesh.split_barycentric = true;
      const auto built = build<3>(scene_of(mesh));
      const auto after = mesh_report(*built);
      EXPECT_EQ(after.n_cells, 24 * before.n_cells);
      EXPECT_NEAR(after.volume, before.volume, 1e-13 * before.volume);
      for (const auto &cell : built->active_cell_iterators())
        if (cell->is_locally_owned()) {
          EXPECT_NEAR(cell->measure(), 1. / 144., 1e-15);
        }
    }
  }

  TEST(MeshSplit, GroupsOfAFileAreInherited)
  {
    const test::BuiltMesh<2> whole(test::mesh_scene(2, plate));
    for (const char *refinements : {"0", "1"}) {
      const test::BuiltMesh<2> cut(test::mesh_scene(
          2, plate + "set split = barycentric\nset refinements = " +
                 refinements + "\n"));
      EXPECT_EQ(cut.triangulation->n_global_active_cells(),
                (refinements[0] == '0' ? 6u : 24u) *
                    whole.triangulation->n_global_active_cells());
      EXPECT_NEAR(cut.volume("steel"), 1., 1e-12);
      EXPECT_NEAR(cut.volume("glue"), 1., 1e-12);
      EXPECT_NEAR(cut.boundary_area("left end"), 1., 1e-12);
      EXPECT_NEAR(cut.boundary_area("right end"), 1., 1e-12);
      EXPECT_NEAR(cut.boundary_area("all"), 6., 1e-12);
      EXPECT_NEAR(cut.inner_area("seam"), 1., 1e-12);
      EXPECT_NEAR(cut.inner_area("crack"), .5, 1e-12);
      EXPECT_EQ(cut.boundary_area("crack"), 0.);
    }
  }

  TEST(MeshSplit, BodiesCutTheirOwnTriangles)
  {
    MeshInput a = cells_of_side_one("crossed triangles", 2, 2), b = a;
    b.lower[0] = 2.;
    b.upper[0] = 4.;
    a.split_barycentric = b.split_barycentric = true;
    EXPECT_EQ(report<2>(scene_of<2>({a, b})).n_cells, 2 * 96u);
    // a half of an edge is no edge
    b.split_barycentric = false;
    EXPECT_TRUE(
        contains(problems_of<2>(scene_of<2>({a, b})), "`a` and `b` touch"));
  }

  TEST(MeshSplit, WhatHasNoTrianglesIsRefused)
  {
    const std::string box = "set upper corner = 1, 1\nset cells = 1, 1\n",
                      block = "set upper corner = 1, 1, 1\n"
                              "set cells = 1, 1, 1\n",
                      quads = "set type = file\nset file = " +
                              std::string(NSFD_SOURCE_DIR) +
                              "/tests/meshes/plate_quads.msh\n";
    const auto expect = [](const std::string &text, const std::string &reason,
                           const std::string &advice) {
      EXPECT_TRUE(
          contains(text, "split = barycentric cuts triangles, but " + reason) ||
          contains(text, "split = barycentric cuts tetrahedra, but " + reason))
          << text;
      EXPECT_TRUE(contains(text, advice)) << text;
    };
    EXPECT_EQ(errors(2, "set type = crossed triangles\n" + box), "");
    EXPECT_EQ(errors(2, plate), "");
    EXPECT_EQ(errors(3, "set type = tetrahedra\n" + block), "");
    expect(errors(2, box), "the cells are quads",
           "take type = isotropic, crossed triangles");
    expect(errors(2, quads), "the cells are quads",
           "mesh the file with triangles");
    expect(errors(2, "set type = voronoi\nset upper corner = 1, 1\nset grains "
                     "= 3\nset element size = 0.2\n"),
           "the cells are quads", "polycrystal.geo");
    expect(errors(2, "set type = hyper_ball\n"), "the cells are quads",
           "crossed triangles");
    expect(errors(3, block), "the cells are hexahedra", "refinements = 1");
    expect(errors(2, plate + "set split simplices = true\n"),
           "`split simplices = true` has made quads", "one of the two");
    EXPECT_TRUE(contains(errors(2, "set type = file\nset file = none.msh\n"),
                         "there is no file"));
    EXPECT_TRUE(contains(
        test::errors_of(test::mesh_scene(
            2, "set type = crossed triangles\nset split = six\n" + box)),
        "barycentric"));
  }

  TEST(MeshSplit, ElasticFacesKeepTheEnergy)
  {
    const std::string plate_on_springs = R"(
set dimension = 2
subsection Mesh
  set type         = crossed triangles
  set upper corner = 4, 2
  set cells        = 4, 2
  set distortion   = 0.2
  set split        = barycentric
end
subsection Material: solid
  set Young modulus      = 1
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = exp(-((x - 2)^2 + (y - 1)^2))
end
subsection Interface: all
  set law                  = elastic
  set normal stiffness     = 21
  set tangential stiffness = 7
end
subsection Time
  set end   = 1000
  set step  = 0.5 courant
  set theta = 0.5
end
)";
    test::Scene<2> scene(plate_on_springs);
    const double energy = scene.energy();
    for (unsigned int step = 0; step < 30; ++step)
      scene.advance();
    EXPECT_NEAR(scene.energy(), energy, 1e-10 * energy);
  }
} // namespace mesh_checks::test_mesh_split
