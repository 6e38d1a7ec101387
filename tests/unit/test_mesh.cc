#include "mesh/mesh_builder.h"
#include "mesh/mesh_types.h"

#include <deal.II/base/mpi.h>
#include <deal.II/distributed/shared_tria.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/grid/grid_tools.h>

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numeric>

// Every test is right on any number of ranks.

using namespace nsfd;
using namespace dealii;

namespace test_mesh
{
  MeshInput box(const std::string &type, const std::vector<double> &lower,
                const std::vector<double> &upper,
                const std::vector<unsigned int> &cells)
  {
    MeshInput mesh;
    mesh.type = type;
    mesh.lower = lower;
    mesh.upper = upper;
    mesh.cells = cells;
    return mesh;
  }

  /** Box of p cells of side 1 per direction. */
  MeshInput cells_of_side_one(const std::string &type, const unsigned int dim,
                              const unsigned int p)
  {
    return box(type, std::vector<double>(dim, 0.),
               std::vector<double>(dim, double(p)),
               std::vector<unsigned int>(dim, p));
  }

  MeshInput generator(const std::string &name, const std::string &arguments)
  {
    MeshInput mesh;
    mesh.type = name;
    mesh.generator_arguments = arguments;
    return mesh;
  }

  SceneInput scene_of(const MeshInput &mesh)
  {
    SceneInput scene;
    scene.mesh = mesh;
    return scene;
  }

  template <int dim>
  SceneInput scene_of(const std::vector<MeshInput> &bodies)
  {
    SceneInput scene;
    scene.dimension = dim;
    scene.mesh.type = "bodies";
    for (unsigned int b = 0; b < bodies.size(); ++b)
      scene.bodies.push_back({std::string(1, char('a' + b)), bodies[b], 0.});
    return scene;
  }

  template <int dim>
  using Vertices = std::map<CellId, std::vector<Point<dim>>>;

  template <int dim>
  Vertices<dim> vertices(const Triangulation<dim> &triangulation)
  {
    Vertices<dim> result;
    for (const auto &cell : triangulation.active_cell_iterators())
      if (!cell->is_artificial())
        for (const unsigned int v : cell->vertex_indices())
          result[cell->id()].push_back(cell->vertex(v));
    return result;
  }

  /**
   * Build on all ranks; own and ghost cells must be those of the whole mesh,
   * to the last bit, and the report the same.
   */
  template <int dim>
  std::unique_ptr<Triangulation<dim>> build(const SceneInput &scene)
  {
    std::vector<std::string> problems;
    auto mesh = build_mesh<dim>(scene, MPI_COMM_WORLD, problems);
    for (const std::string &problem : problems)
      ADD_FAILURE() << problem;
    if (!mesh)
      return mesh;
    const auto whole = build_mesh<dim>(scene, MPI_COMM_SELF, problems);
    const Vertices<dim> reference = vertices(*whole);
    EXPECT_EQ(mesh->n_global_active_cells(), reference.size());
    bool equal = true;
    for (const auto &[id, points] : vertices(*mesh))
      equal &= reference.count(id) == 1 && reference.at(id) == points;
    EXPECT_TRUE(equal);
    for (const auto &cell : mesh->cell_iterators()) {
      EXPECT_EQ(cell->manifold_id(), numbers::flat_manifold_id);
      break;
    }
    const MeshReport a = mesh_report(*mesh), b = mesh_report(*whole);
    EXPECT_EQ(a.n_cells, b.n_cells);
    EXPECT_EQ(a.smallest_edge, b.smallest_edge);
    EXPECT_EQ(a.largest_edge, b.largest_edge);
    EXPECT_EQ(a.smallest_height, b.smallest_height);
    EXPECT_EQ(a.smallest_angle, b.smallest_angle);
    EXPECT_EQ(a.volume, b.volume);
    EXPECT_EQ(a.inner_face_area, b.inner_face_area);
    return mesh;
  }

  template <int dim>
  MeshReport report(const SceneInput &scene)
  {
    const auto mesh = build<dim>(scene);
    return mesh ? mesh_report(*mesh) : MeshReport();
  }

  template <int dim>
  MeshReport report(const MeshInput &mesh)
  {
    return report<dim>(scene_of(mesh));
  }

  /** Problems of a mesh that cannot be built. */
  template <int dim>
  std::string problems_of(const SceneInput &scene)
  {
    std::vector<std::string> problems;
    EXPECT_EQ(build_mesh<dim>(scene, MPI_COMM_WORLD, problems), nullptr);
    EXPECT_FALSE(problems.empty());
    return std::accumulate(problems.begin(), problems.end(), std::string(),
                           [](const std::string &a, const std::string &b) {
                             return a + (a.empty() ? "" : "\n") + b;
                           });
  }

  bool contains(const std::string &text, const std::string &part)
  {
    return text.find(part) != std::string::npos;
  }

  /** Own boundary faces of all ranks that `where` holds for. */
  template <int dim>
  unsigned int count_boundary_faces(const Triangulation<dim> &mesh,
                                    const MeshGroups<dim> &groups,
                                    const Where &where)
  {
    unsigned int n = 0;
    for (const auto &cell : mesh.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int f : cell->face_indices())
          n += groups.holds_boundary_face(where, cell, f);
    return Utilities::MPI::sum(n, MPI_COMM_WORLD);
  }

  Where side(const std::string &name)
  {
    return {Where::Kind::side, name, {}, {}};
  }

  Where group(const std::string &name)
  {
    return {Where::Kind::group, name, {}, {}};
  }

  Where between(const std::string &a, const std::string &b)
  {
    return {Where::Kind::between_materials, "", {{a, b}}, {}};
  }

  MaterialInput material(const std::string &name, const Where &where)
  {
    MaterialInput result;
    result.name = name;
    result.where = where;
    return result;
  }

  TEST(Mesh, RectangleAndBrick)
  {
    const auto quads = report<2>(box("rectangle", {-1., 2.}, {2., 4.}, {6, 8}));
    EXPECT_EQ(quads.n_cells, 48u);
    EXPECT_NEAR(quads.volume, 6., 1e-12);
    EXPECT_NEAR(quads.inner_face_area, 5 * 2. + 7 * 3., 1e-12);
    EXPECT_NEAR(quads.smallest_edge, .25, 1e-14);
    EXPECT_NEAR(quads.largest_edge, .5, 1e-14);
    EXPECT_NEAR(quads.smallest_height, .25, 1e-14);
    EXPECT_NEAR(quads.smallest_angle, 90., 1e-9);
    EXPECT_NEAR(quads.smallest_scaled_jacobian, 1., 1e-12);

    const auto hexes =
        report<3>(box("brick", {0., 0., 0.}, {1., 2., 3.}, {2, 3, 4}));
    EXPECT_EQ(hexes.n_cells, 24u);
    EXPECT_NEAR(hexes.volume, 6., 1e-12);
    EXPECT_NEAR(hexes.inner_face_area, 1 * 6. + 2 * 3. + 3 * 2., 1e-12);
    EXPECT_NEAR(hexes.smallest_height, .5, 1e-14);
  }

  TEST(Mesh, RefinementsDoubleTheCells)
  {
    MeshInput mesh = box("rectangle", {0., 0.}, {3., 3.}, {3, 3});
    mesh.refinements = 2;
    const auto refined = report<2>(mesh);
    EXPECT_EQ(refined.n_cells, 144u);
    // Z = 2/L less the outline
    EXPECT_NEAR(refined.inner_face_area, 2 * 11 * 3., 1e-11);
    EXPECT_TRUE(dynamic_cast<parallel::distributed::Triangulation<2> *>(
        build<2>(scene_of(mesh)).get()));

    mesh.type = "crossed triangles";
    EXPECT_EQ(report<2>(mesh).n_cells, 4 * 144u);
    mesh = cells_of_side_one("tetrahedra", 3, 1);
    mesh.refinements = 1;
    EXPECT_EQ(report<3>(mesh).n_cells, 6 * 8u);
  }

  // E-Z: l = 2 sqrt2 L p^2 + 2 p (p-1) L on 4 p^2 triangles
  TEST(Mesh, CrossedTriangles)
  {
    const std::map<unsigned int, double> inner_length = {
        {1, 2.828427}, {2, 15.313708}, {4, 69.254834}};
    for (const auto &[p, length] : inner_length) {
      const auto mesh = report<2>(cells_of_side_one("crossed triangles", 2, p));
      EXPECT_EQ(mesh.n_cells, 4 * p * p);
      EXPECT_NEAR(mesh.inner_face_area,
                  2 * std::sqrt(2.) * p * p + 2. * p * (p - 1), 1e-11);
      EXPECT_NEAR(mesh.inner_face_area, length, 1e-6);
      EXPECT_NEAR(mesh.interface_density, length / (p * p), 1e-6);
      EXPECT_NEAR(mesh.volume, double(p * p), 1e-12);
      // height onto the longest side
      EXPECT_NEAR(mesh.smallest_height, .5, 1e-12);
      EXPECT_NEAR(mesh.smallest_angle, 45., 1e-9);
      EXPECT_NEAR(mesh.largest_angle, 90., 1e-9);
    }
  }

  // One diagonal: sqrt2 per square; Kuhn: faces of 6 tetrahedra of volume 1/6
  // are two of area 1/2 and two of area sqrt2/2, so 3 + 3 sqrt2 per cube
  TEST(Mesh, DiagonalTrianglesAndTetrahedra)
  {
    for (const unsigned int p : {1u, 2u, 3u}) {
      const auto triangles =
          report<2>(cells_of_side_one("diagonal triangles", 2, p));
      EXPECT_EQ(triangles.n_cells, 2 * p * p);
      EXPECT_NEAR(triangles.inner_face_area,
                  std::sqrt(2.) * p * p + 2. * p * (p - 1), 1e-11);
      const auto tetrahedra = report<3>(cells_of_side_one("tetrahedra", 3, p));
      EXPECT_EQ(tetrahedra.n_cells, 6 * p * p * p);
      EXPECT_NEAR(tetrahedra.volume, double(p * p * p), 1e-11);
      EXPECT_NEAR(tetrahedra.inner_face_area,
                  (3 + 3 * std::sqrt(2.)) * p * p * p - 3. * p * p, 1e-10);
      EXPECT_NEAR(tetrahedra.smallest_height, std::sqrt(.5), 1e-12);
      EXPECT_NEAR(tetrahedra.largest_edge, std::sqrt(3.), 1e-12);
    }
  }

  TEST(Mesh, NotchedPlate)
  {
    MeshInput mesh = box("notched plate", {1., 0.}, {11., 5.}, {10, 5});
    mesh.notch_length = 4.;
    mesh.notch_height = 2.5;
    mesh.notch_width = 1.;
    const auto plate = report<2>(mesh);
    EXPECT_EQ(plate.n_cells, 46u);
    EXPECT_NEAR(plate.volume, 46., 1e-11);
    // 9 * 5 + 10 * 4 edges less the 4 + 2 * 4 of the slot
    EXPECT_NEAR(plate.inner_face_area, 45. + 40. - 12., 1e-11);

    mesh.refinements = 1;
    EXPECT_NEAR(report<2>(mesh).volume, 46., 1e-11);

    mesh.refinements = 0;
    mesh.notch_width = 0.;
    EXPECT_EQ(report<2>(mesh).n_cells, 50u);

    mesh.notch_width = .3;
    mesh.notch_height = 3.;
    EXPECT_TRUE(contains(problems_of<2>(scene_of(mesh)), "no cell centre"));

    MeshInput plate_3d =
        box("notched plate", {0., 0., 0.}, {4., 3., 2.}, {4, 3, 2});
    plate_3d.notch_length = 2.;
    plate_3d.notch_height = 1.5;
    plate_3d.notch_width = 1.;
    EXPECT_NEAR(report<3>(plate_3d).volume, 24. - 4., 1e-12);

    plate_3d.notch_length = 9.;
    plate_3d.notch_width = 9.;
    EXPECT_TRUE(contains(problems_of<3>(scene_of(plate_3d)), "no cell"));
  }

  TEST(Mesh, BodiesAreGluedWhereFacesCoincide)
  {
    const MeshInput a = box("rectangle", {0., 0.}, {1., 1.}, {4, 4});
    MeshInput b = box("rectangle", {1., 0.}, {3., 1.}, {8, 4});
    const auto glued = report<2>(scene_of<2>({a, b}));
    EXPECT_EQ(glued.n_cells, 48u);
    EXPECT_NEAR(glued.volume, 3., 1e-12);
    EXPECT_NEAR(glued.inner_face_area, 11 * 1. + 3 * 3., 1e-11);

    // rounding of the corner is no gap
    b.lower[0] += 1e-13;
    EXPECT_NEAR(report<2>(scene_of<2>({a, b})).inner_face_area, 20., 1e-11);

    // 1e-9 of a cell is one
    b.lower[0] = 1. + .25e-9;
    EXPECT_NEAR(report<2>(scene_of<2>({a, b})).inner_face_area, 19., 1e-8);

    // the refinement of the scene comes on top of that of the bodies
    SceneInput scene = scene_of<2>({a, b});
    scene.bodies[1].mesh.lower[0] = 1.;
    scene.bodies[1].mesh.cells = {4, 2};
    scene.bodies[1].mesh.refinements = 1;
    scene.mesh.refinements = 1;
    EXPECT_NEAR(report<2>(scene).inner_face_area, 23. + 7 * 3., 1e-11);
  }

  TEST(Mesh, BodiesInThreeDimensionsAndOfTriangles)
  {
    const MeshInput a = cells_of_side_one("brick", 3, 2);
    const MeshInput b = box("brick", {0., 0., 2.}, {2., 2., 4.}, {2, 2, 2});
    const MeshInput c = box("brick", {5., 0., 0.}, {6., 1., 1.}, {1, 1, 1});
    const auto scene = scene_of<3>({a, b, c});
    EXPECT_NEAR(report<3>(scene).inner_face_area, 3 * 4. + 3 * 4. + 4., 1e-11);
    const auto mesh = build<3>(scene);
    std::array<unsigned int, 3> n{};
    for (const auto &cell : mesh->active_cell_iterators())
      if (cell->is_locally_owned())
        ++n[cell->material_id()];
    for (unsigned int i = 0; i < 3; ++i)
      EXPECT_EQ(Utilities::MPI::sum(n[i], MPI_COMM_WORLD), i == 2 ? 1u : 8u);

    const MeshInput t = cells_of_side_one("crossed triangles", 2, 2);
    MeshInput u = t;
    u.lower[1] += 2.;
    u.upper[1] += 2.;
    EXPECT_NEAR(report<2>(scene_of<2>({t, u})).inner_face_area,
                2 * 15.313708498984761 + 2., 1e-10);
    MeshInput v = cells_of_side_one("tetrahedra", 3, 1), w = v;
    w.lower[0] = 1.;
    w.upper[0] = 2.;
    EXPECT_NEAR(report<3>(scene_of<3>({v, w})).inner_face_area,
                2 * (3 * std::sqrt(2.)) + 1., 1e-11);
  }

  TEST(Mesh, BodiesThatCannotBe)
  {
    const MeshInput a = box("rectangle", {0., 0.}, {1., 1.}, {4, 4});
    EXPECT_TRUE(
        contains(problems_of<2>(scene_of<2>(
                     {a, box("rectangle", {1., 0.}, {2., 1.}, {4, 3})})),
                 "`a` and `b` touch"));
    EXPECT_TRUE(
        contains(problems_of<2>(scene_of<2>(
                     {a, box("rectangle", {1., .1}, {2., 1.1}, {4, 4})})),
                 "`a` and `b` touch"));
    EXPECT_TRUE(
        contains(problems_of<2>(scene_of<2>(
                     {a, box("rectangle", {.9, 0.}, {2., 1.}, {4, 4})})),
                 "`a` and `b` overlap"));
    EXPECT_TRUE(contains(
        problems_of<2>(scene_of<2>(
            {a, box("crossed triangles", {1., 0.}, {2., 1.}, {4, 4})})),
        "different kinds"));
    EXPECT_TRUE(contains(problems_of<2>(scene_of<2>(std::vector<MeshInput>())),
                         "Body:"));
    EXPECT_TRUE(contains(problems_of<2>(scene_of<2>(
                             {box("bodies", {0., 0.}, {1., 1.}, {1, 1})})),
                         "Body: a: there is no mesh type `bodies`"));
    EXPECT_TRUE(
        contains(problems_of<3>(scene_of<3>(
                     {box("brick", {0., 0., 0.}, {1., 1., 1.}, {2, 2, 2}),
                      box("brick", {0., .1, 1.}, {1., .9, 2.}, {2, 2, 2})})),
                 "`a` and `b` touch"));
  }

  TEST(Mesh, GeneratorsByName)
  {
    // three squares of side 1
    MeshInput mesh = generator("hyper_L", "-1. : 1. : false");
    mesh.refinements = 2;
    const auto l_shape = report<2>(mesh);
    EXPECT_EQ(l_shape.n_cells, 48u);
    EXPECT_NEAR(l_shape.volume, 3., 1e-12);

    // a polygon inscribed in the circle: vertices are on it, edges straight
    mesh = generator("hyper_ball", "0., 0. : 2. : false");
    mesh.refinements = 3;
    const auto ball = build<2>(scene_of(mesh));
    EXPECT_EQ(ball->n_global_active_cells(), 5 * 64u);
    for (const auto &cell : ball->active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int f : cell->face_indices())
          if (cell->face(f)->at_boundary()) {
            EXPECT_NEAR(cell->face(f)->vertex(0).norm(), 2., 1e-12);
            EXPECT_NEAR(
                cell->face(f)->center().distance(
                    .5 * (cell->face(f)->vertex(0) + cell->face(f)->vertex(1))),
                0., 1e-15);
          }
    // regular polygon of 32 corners
    EXPECT_NEAR(mesh_report(*ball).volume,
                .5 * 32 * 4. * std::sin(2. * numbers::PI / 32), 1e-10);

    mesh = generator("hyper_shell", "0., 0. : 1. : 2. : 12 : false");
    EXPECT_NEAR(report<2>(mesh).volume,
                .5 * 12 * 3. * std::sin(2. * numbers::PI / 12), 1e-10);
    // what straight cells leave out of the ball falls with the square of h
    mesh = generator("hyper_ball", "0., 0., 0. : 1. : false");
    std::array<double, 2> left_out{};
    for (const unsigned int r : {1, 2}) {
      mesh.refinements = r + 1;
      left_out[r - 1] = 4. / 3. * numbers::PI - report<3>(mesh).volume;
    }
    EXPECT_NEAR(left_out[0] / left_out[1], 4., .5);
    mesh = generator("hyper_shell", "0., 0., 0. : 1. : 2. : 6 : false");
    mesh.refinements = 1;
    EXPECT_EQ(report<3>(mesh).n_cells, 48u);
    mesh = generator("plate_with_a_hole",
                     ".4 : 1. : 1. : 1. : 1. : 1. : 0., 0. : 0 : 1 : 1. : 2 : "
                     "true");
    EXPECT_NEAR(report<2>(mesh).volume, 16. - .16 * numbers::PI, .1);
    // the two sides of the slit are two faces
    mesh = generator("hyper_cube_slit", "0. : 1. : false");
    mesh.refinements = 2;
    EXPECT_NEAR(report<2>(mesh).inner_face_area, 14. - .5, 1e-12);
  }

  /** Arguments in two and in three dimensions; empty: there is no such mesh. */
  struct GeneratorRow {
    const char *name, *plane, *space;
  };

  const GeneratorRow generator_rows[] = {
      {"hyper_cube", "0 : 1 : false", "0 : 1 : false"},
      {"subdivided_hyper_cube", "2 : 0 : 1 : false", "2 : 0 : 1 : false"},
      {"hyper_rectangle", "0, 0 : 1, 1 : false", "0, 0, 0 : 1, 1, 1 : false"},
      {"subdivided_hyper_rectangle", "2, 2 : 0, 0 : 1, 1 : false",
       "2, 2, 2 : 0, 0, 0 : 1, 1, 1 : false"},
      {"hyper_ball", "0, 0 : 1 : false", "0, 0, 0 : 1 : false"},
      {"hyper_ball_balanced", "0, 0 : 1", "0, 0, 0 : 1"},
      {"half_hyper_ball", "0, 0 : 1", "0, 0, 0 : 1"},
      {"quarter_hyper_ball", "0, 0 : 1", "0, 0, 0 : 1"},
      {"hyper_shell", "0, 0 : 1 : 2 : 12 : false",
       "0, 0, 0 : 1 : 2 : 12 : false"},
      {"half_hyper_shell", "0, 0 : 1 : 2 : 12 : false",
       "0, 0, 0 : 1 : 2 : 5 : false"},
      {"quarter_hyper_shell", "0, 0 : 1 : 2 : 12 : false",
       "0, 0, 0 : 1 : 2 : 3 : false"},
      {"concentric_hyper_shells", "0, 0 : 1 : 2 : 2 : 0 : 12 : false",
       "0, 0, 0 : 1 : 2 : 2 : 0 : 12 : false"},
      {"eccentric_hyper_shell", "0, 0 : 0, 0 : 1 : 2 : 12",
       "0, 0, 0 : 0, 0, 0 : 1 : 2 : 12"},
      {"hyper_L", "0 : 1 : false", "0 : 1 : false"},
      {"hyper_cross", "1, 0, 1, 0 : false", "1, 0, 1, 0, 1, 0 : false"},
      {"hyper_cube_slit", "0 : 1 : false", "0 : 1 : false"},
      {"hyper_cube_with_cylindrical_hole", "0.25 : 0.5 : 0.5 : 1 : false",
       "0.25 : 0.5 : 0.5 : 1 : false"},
      {"enclosed_hyper_cube", "0 : 1 : 1 : false", "0 : 1 : 1 : false"},
      {"plate_with_a_hole",
       ".4 : 1 : 1 : 1 : 1 : 1 : 0, 0 : 0 : 1 : 1 : 2 : true",
       ".4 : 1 : 1 : 1 : 1 : 1 : 0, 0, 0 : 0 : 1 : 1 : 2 : true"},
      {"channel_with_cylinder", "0.03 : 2 : 2 : false", "0.03 : 2 : 2 : false"},
      {"cheese", "2, 2", "2, 2, 2"},
      {"general_cell", "0, 0 ; 1, 0 ; 0, 1 ; 1, 1 : false",
       "0, 0, 0 ; 1, 0, 0 ; 0, 1, 0 ; 1, 1, 0 ; "
       "0, 0, 1 ; 1, 0, 1 ; 0, 1, 1 ; 1, 1, 1 : false"},
      {"simplex", "0, 0 ; 1, 0 ; 0, 1",
       "0, 0, 0 ; 1, 0, 0 ; 0, 1, 0 ; 0, 0, 1"},
      {"cylinder", "1 : 1", "1 : 1"},
      {"subdivided_cylinder", "", "2 : 1 : 1"},
      {"cylinder_shell", "", "2 : 1 : 2 : 12 : 2"},
      {"truncated_cone", "1 : 0.5 : 1", "1 : 0.5 : 1"},
      {"moebius", "", "16 : 0 : 1 : 0.5"},
      {"torus", "", "2 : 0.5 : 6 : 6.283185307179586"},
  };

  /** A mesh with the right arguments, a sentence with others. */
  template <int dim>
  void expect_generated(const GeneratorRow &row)
  {
    SCOPED_TRACE(std::string(row.name) + ", dim = " + std::to_string(dim));
    const std::string arguments = dim == 2 ? row.plane : row.space;
    if (arguments.empty()) {
      EXPECT_TRUE(
          contains(problems_of<dim>(scene_of(generator(row.name, "1 : 1"))),
                   "`" + std::string(row.name) + "` is a mesh of "));
    } else {
      const MeshReport mesh = report<dim>(generator(row.name, arguments));
      EXPECT_GE(mesh.n_cells, 1u);
      EXPECT_GT(mesh.volume, 0.);
      EXPECT_TRUE(
          contains(problems_of<dim>(scene_of(generator(row.name, "one"))),
                   "`" + std::string(row.name) + "` does not accept `one`"));
    }
  }

  TEST(Mesh, EveryListedGeneratorMakesAMeshOrIsRefused)
  {
    for (const GeneratorRow &row : generator_rows) {
      expect_generated<2>(row);
      expect_generated<3>(row);
    }
    for (const MeshType &type : mesh_types())
      if (type.kind == MeshType::Kind::generator) {
        EXPECT_TRUE(std::any_of(
            std::begin(generator_rows), std::end(generator_rows),
            [&](const GeneratorRow &row) { return type.name == row.name; }))
            << "no row for the generator " << type.name;
      }
  }

  TEST(Mesh, BodiesFromGenerators)
  {
    MeshInput ball = generator("hyper_ball", "0., 0. : 1. : false");
    ball.refinements = 2;
    MeshInput shell = generator("hyper_shell", "0., 0. : 1. : 2. : 16 : false");
    // outline of the ball: 4 * 2^2 corners, also those of the shell
    const auto scene = scene_of<2>({ball, shell});
    const double inner = report<2>(scene).inner_face_area;
    const double alone =
        report<2>(ball).inner_face_area + report<2>(shell).inner_face_area;
    EXPECT_NEAR(inner - alone, 16 * 2. * std::sin(numbers::PI / 16), 1e-10);
  }

  TEST(Mesh, WrongInputIsASentence)
  {
    EXPECT_TRUE(contains(problems_of<2>(scene_of(generator("hyper_bal", ""))),
                         "there is no mesh type `hyper_bal`; there are "
                         "rectangle, brick"));
    const std::string text =
        problems_of<2>(scene_of(generator("hyper_ball", "0., 0.")));
    EXPECT_TRUE(contains(text, "does not accept `0., 0.`")) << text;
    EXPECT_FALSE(contains(text, "MAX_DOUBLE")) << text;
    EXPECT_FALSE(contains(text, "\n")) << text;
    EXPECT_TRUE(
        contains(problems_of<2>(scene_of(generator("torus", ""))), "torus"));
    EXPECT_TRUE(
        contains(problems_of<3>(scene_of(cells_of_side_one("rectangle", 3, 1))),
                 "`rectangle` is a mesh of 2 dimensions, the scene has 3"));
    EXPECT_TRUE(
        contains(problems_of<2>(scene_of(cells_of_side_one("brick", 2, 1))),
                 "3 dimensions"));
    EXPECT_TRUE(contains(
        problems_of<2>(scene_of(box("rectangle", {0., 1.}, {1., 1.}, {1, 1}))),
        "must lie beyond"));
    EXPECT_TRUE(contains(
        problems_of<2>(scene_of(box("rectangle", {0., 0.}, {1., 1.}, {1, 0}))),
        "`cells` must be at least 1 in y"));
    EXPECT_TRUE(
        contains(problems_of<2>(scene_of(
                     box("rectangle", {0., 0.}, {1., std::nan("")}, {1, 1}))),
                 "must lie beyond"));
    EXPECT_TRUE(
        contains(problems_of<2>(scene_of(
                     box("rectangle", {0., 0.}, {1., 1.}, {1000000, 1000000}))),
                 "reduce"));
    EXPECT_TRUE(
        contains(problems_of<2>(scene_of(box("rectangle", {0.}, {1.}, {1}))),
                 "need 2 entries"));
  }

  TEST(Mesh, DistortionMovesInteriorVerticesOnly)
  {
    for (const char *type :
         {"rectangle", "crossed triangles", "diagonal triangles"}) {
      MeshInput mesh = box(type, {0., 0.}, {2., 1.}, {16, 8});
      const double straight = report<2>(mesh).inner_face_area;
      mesh.distortion = .2;
      const auto once = report<2>(mesh), again = report<2>(mesh);
      EXPECT_EQ(once.inner_face_area, again.inner_face_area);
      EXPECT_NEAR(once.volume, 2., 1e-12) << type;
      EXPECT_NE(once.inner_face_area, straight);
      EXPECT_GT(once.smallest_scaled_jacobian, 0.);
      EXPECT_LT(
          once.smallest_angle,
          report<2>(box(type, {0., 0.}, {2., 1.}, {16, 8})).smallest_angle);
      mesh.seed = 2;
      EXPECT_NE(report<2>(mesh).inner_face_area, once.inner_face_area);
    }
    for (const char *type : {"brick", "tetrahedra"}) {
      MeshInput mesh = cells_of_side_one(type, 3, 4);
      mesh.distortion = .2;
      const auto distorted = report<3>(mesh);
      EXPECT_NEAR(distorted.volume, 64., 1e-10) << type;
      EXPECT_GT(distorted.smallest_scaled_jacobian, 0.) << type;
    }
    // after the refinement
    MeshInput coarse = box("rectangle", {0., 0.}, {1., 1.}, {4, 4}),
              fine = box("rectangle", {0., 0.}, {1., 1.}, {8, 8});
    coarse.refinements = 1;
    coarse.distortion = fine.distortion = .1;
    EXPECT_EQ(report<2>(coarse).inner_face_area,
              report<2>(fine).inner_face_area);
  }

  // The same scene in other units is the same mesh.
  TEST(Mesh, DistortionDoesNotDependOnTheUnit)
  {
    MeshInput metre = box("rectangle", {0., 0.}, {3., 2.}, {30, 20}),
              micron = box("rectangle", {0., 0.}, {3e-6, 2e-6}, {30, 20});
    metre.distortion = micron.distortion = .2;
    const auto a = report<2>(metre), b = report<2>(micron);
    EXPECT_NEAR(a.inner_face_area, 1e6 * b.inner_face_area, 1e-9);
    EXPECT_NEAR(a.smallest_angle, b.smallest_angle, 1e-7);
  }

  TEST(Mesh, InvertedCellsAreReported)
  {
    MeshInput mesh = cells_of_side_one("rectangle", 2, 8);
    mesh.distortion = 2.;
    const std::string text = problems_of<2>(scene_of(mesh));
    EXPECT_TRUE(contains(text, "is inverted")) << text;
    EXPECT_TRUE(contains(text, "Mesh: cell ")) << text;
    EXPECT_TRUE(contains(text, " at (")) << text;
    mesh = cells_of_side_one("tetrahedra", 3, 3);
    mesh.distortion = 2.;
    EXPECT_TRUE(contains(problems_of<3>(scene_of(mesh)), "is inverted"));
    // by us, or by deal.II where it is built with checks
    for (const char *corners : {"0., 0. ; 0., 1. ; 1., 0. ; 1., 1. : false",
                                "0., 0. ; 1., 0. ; 0., 0. ; 1., 0. : false"}) {
      const std::string of_cell =
          problems_of<2>(scene_of(generator("general_cell", corners)));
      EXPECT_TRUE(contains(of_cell, "is inverted") ||
                  contains(of_cell, "is degenerate") ||
                  contains(of_cell, "does not accept"))
          << of_cell;
    }
  }

  TEST(MeshGroups, SidesOfTheBoundingBox)
  {
    MeshInput input = box("notched plate", {-1e-6, 0.}, {9e-6, 5e-6}, {10, 5});
    input.notch_length = 4e-6;
    input.notch_height = 2.5e-6;
    input.notch_width = 1e-6;
    const SceneInput scene = scene_of(input);
    const auto mesh = build<2>(scene);
    const MeshGroups<2> groups(scene, *mesh);
    EXPECT_DOUBLE_EQ(groups.lower()[0], -1e-6);
    EXPECT_DOUBLE_EQ(groups.upper()[1], 5e-6);
    EXPECT_EQ(count_boundary_faces(*mesh, groups, side("left")), 4u);
    EXPECT_EQ(count_boundary_faces(*mesh, groups, side("right")), 5u);
    EXPECT_EQ(count_boundary_faces(*mesh, groups, side("bottom")), 10u);
    EXPECT_EQ(count_boundary_faces(*mesh, groups, side("top")), 10u);
    EXPECT_EQ(count_boundary_faces(*mesh, groups, side("front")), 0u);
    // outline and slot
    EXPECT_EQ(count_boundary_faces(*mesh, groups, Where()), 29u + 9u);
    EXPECT_TRUE(contains(groups.missing(side("front")), "front"));
    EXPECT_EQ(groups.missing(side("top")), "");
  }

  TEST(MeshGroups, SidesInThreeDimensions)
  {
    for (const char *type : {"brick", "tetrahedra"}) {
      const unsigned int n = std::string(type) == "brick" ? 1 : 2;
      const SceneInput scene =
          scene_of(box(type, {0., 0., 0.}, {2., 3., 4.}, {2, 3, 4}));
      const auto mesh = build<3>(scene);
      const MeshGroups<3> groups(scene, *mesh);
      EXPECT_EQ(count_boundary_faces(*mesh, groups, side("right")), n * 12);
      EXPECT_EQ(count_boundary_faces(*mesh, groups, side("bottom")), n * 8);
      EXPECT_EQ(count_boundary_faces(*mesh, groups, side("back")), n * 6);
      EXPECT_EQ(count_boundary_faces(*mesh, groups, side("front")), n * 6);
      EXPECT_EQ(count_boundary_faces(*mesh, groups, Where()), n * 52);
    }
  }

  TEST(MeshGroups, BoundaryIdsOfGenerators)
  {
    MeshInput input = generator("hyper_shell", "0., 0. : 1. : 2. : 12 : true");
    input.refinements = 1;
    const SceneInput scene = scene_of(input);
    const auto mesh = build<2>(scene);
    const MeshGroups<2> groups(scene, *mesh);
    // colorize: 0 inside, 1 outside
    EXPECT_EQ(count_boundary_faces(*mesh, groups, group("0")), 24u);
    EXPECT_EQ(count_boundary_faces(*mesh, groups, group("1")), 24u);
    EXPECT_EQ(count_boundary_faces(*mesh, groups, group("2")), 0u);
    EXPECT_EQ(groups.missing(group("1")), "");
    EXPECT_TRUE(contains(groups.missing(group("2")), "no group `2`"));

    MeshInput cube = generator("hyper_cube", "0. : 1. : true");
    cube.refinements = 2;
    const SceneInput scene_3d = scene_of(cube);
    const auto mesh_3d = build<3>(scene_3d);
    const MeshGroups<3> groups_3d(scene_3d, *mesh_3d);
    for (const char *id : {"0", "1", "2", "3", "4", "5"})
      EXPECT_EQ(count_boundary_faces(*mesh_3d, groups_3d, group(id)), 16u);
  }

  TEST(MeshGroups, Bodies)
  {
    const SceneInput scene =
        scene_of<2>({box("rectangle", {0., 0.}, {1., 1.}, {4, 4}),
                     box("rectangle", {1., 0.}, {2., 1.}, {4, 4})});
    const auto mesh = build<2>(scene);
    const MeshGroups<2> groups(scene, *mesh);
    EXPECT_EQ(count_boundary_faces(*mesh, groups, group("a")), 12u);
    EXPECT_EQ(count_boundary_faces(*mesh, groups, group("b")), 12u);
    EXPECT_TRUE(contains(groups.missing(group("c")), "bodies a, b"));
    for (const auto &cell : mesh->active_cell_iterators())
      if (cell->is_locally_owned()) {
        const bool left = cell->center()[0] < 1.;
        EXPECT_EQ(groups.holds_cell(group("a"), cell), left);
        EXPECT_EQ(groups.holds_cell(group("b"), cell), !left);
      }
    const Point<2> p(1., .5);
    EXPECT_TRUE(groups.holds_interior_face(group("b"), p, "", "", {{1, 1}}));
    EXPECT_FALSE(groups.holds_interior_face(group("b"), p, "", "", {{0, 1}}));
  }

  TEST(MeshGroups, InteriorFaces)
  {
    const SceneInput scene = scene_of(cells_of_side_one("rectangle", 2, 2));
    const auto mesh = build<2>(scene);
    const MeshGroups<2> groups(scene, *mesh);
    const Point<2> p(1., .5);
    EXPECT_TRUE(groups.holds_interior_face(Where(), p, "a", "a"));
    EXPECT_TRUE(groups.holds_interior_face(between("a", "b"), p, "a", "b"));
    EXPECT_TRUE(groups.holds_interior_face(between("a", "b"), p, "b", "a"));
    EXPECT_FALSE(groups.holds_interior_face(between("a", "b"), p, "a", "a"));
    EXPECT_FALSE(groups.holds_interior_face(between("a", "b"), p, "a", "c"));
    EXPECT_TRUE(groups.holds_interior_face(between("a", "a"), p, "a", "a"));
    EXPECT_TRUE(groups.holds_interior_face(between("", ""), p, "a", "c"));
    EXPECT_FALSE(groups.holds_interior_face(between("", ""), p, "a", "a"));
    Where where;
    where.kind = Where::Kind::expression;
    where.condition = Expression(1.);
    EXPECT_TRUE(groups.holds_interior_face(where, p, "a", "a"));
    where.condition = Expression(0.);
    EXPECT_FALSE(groups.holds_interior_face(where, p, "a", "a"));
    EXPECT_FALSE(groups.holds_interior_face(side("left"), p, "a", "a"));
  }

  TEST(MeshGroups, MaterialPerCell)
  {
    SceneInput scene =
        scene_of<2>({box("crossed triangles", {0., 0.}, {1., 1.}, {4, 4}),
                     box("crossed triangles", {1., 0.}, {2., 1.}, {4, 4})});
    const auto mesh = build<2>(scene);
    const MeshGroups<2> groups(scene, *mesh);
    scene.materials = {material("right", group("b")), material("rest", Where()),
                       material("unused", Where())};
    std::vector<std::string> problems, warnings;
    const auto index =
        material_indices(scene, groups, *mesh, problems, warnings);
    EXPECT_TRUE(problems.empty());
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_TRUE(contains(warnings[0], "Material: unused: no cell"));
    for (const auto &cell : mesh->active_cell_iterators())
      EXPECT_EQ(index[cell->active_cell_index()],
                cell->is_artificial()    ? numbers::invalid_unsigned_int
                : cell->center()[0] > 1. ? 0u
                                         : 1u);

    // where nothing holds: how many and where
    warnings.clear();
    scene.materials = {material("right", group("b"))};
    material_indices(scene, groups, *mesh, problems, warnings);
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_TRUE(contains(problems[0], "64 of 128 cells have no material"));
    EXPECT_TRUE(contains(problems[0], "(0.0416667, 0.125)")) << problems[0];

    problems.clear();
    scene.materials = {material("x", group("c")), material("rest", Where())};
    material_indices(scene, groups, *mesh, problems, warnings);
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_TRUE(
        contains(problems[0], "Material: x: the mesh has no group `c`"));
  }

  TEST(Mesh, PartsOfAllRanksTouchFewNeighbours)
  {
    const SceneInput scene =
        scene_of(cells_of_side_one("crossed triangles", 2, 16));
    const auto mesh = build<2>(scene), again = build<2>(scene);
    unsigned int n_owned = 0, n_ghosts = 0;
    for (const auto &cell : mesh->active_cell_iterators()) {
      n_owned += cell->is_locally_owned();
      n_ghosts += cell->is_ghost();
    }
    const unsigned int n_ranks =
        Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
    EXPECT_NEAR(double(n_owned), 1024. / n_ranks, .05 * 1024. / n_ranks);
    EXPECT_LT(n_ghosts, n_ranks == 1 ? 1u : 300u);
    EXPECT_EQ(vertices(*mesh), vertices(*again));
  }
} // namespace test_mesh
