#include "mesh_checks.h"

#include "mesh/owned_cells.h"

namespace mesh_checks::test_mesh
{
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

  // A rank has its part and what is around it; some have none.
  TEST(Mesh, SimplicesAreSpreadOverTheRanks)
  {
    const unsigned int n_ranks =
        Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
    const auto tetrahedra = build<3>(
        scene_of(box("tetrahedra", {0., 0., 0.}, {8., 1., 1.}, {16, 2, 2})));
    const auto n_own = owned_cells(*tetrahedra).size();
    const unsigned int n_all = 6 * 64;
    EXPECT_EQ(Utilities::MPI::sum(unsigned(n_own), MPI_COMM_WORLD), n_all);
    EXPECT_LE(n_own, 1.1 * n_all / n_ranks);
    // a layer of two cubes at each end
    EXPECT_LE(tetrahedra->n_active_cells(), n_own + 2 * 2 * 6 * 4 * 1.5);
    const auto two =
        build<2>(scene_of(cells_of_side_one("diagonal triangles", 2, 1)));
    EXPECT_EQ(
        Utilities::MPI::sum(unsigned(owned_cells(*two).size()), MPI_COMM_WORLD),
        2u);
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
      // legs 1 / sqrt2: r = 1 - 1 / sqrt2 of them, R = 1/2
      EXPECT_NEAR(mesh.smallest_radius_ratio, 2. * (std::sqrt(2.) - 1.), 1e-12);
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
      // r = 3 (1/6) / (1 + sqrt2), R of the cube
      EXPECT_NEAR(tetrahedra.smallest_radius_ratio,
                  3. * .5 / (1. + std::sqrt(2.)) / (.5 * std::sqrt(3.)), 1e-12);
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

  TEST(Mesh, BodiesAreJoinedWhereFacesCoincide)
  {
    const MeshInput a = box("rectangle", {0., 0.}, {1., 1.}, {4, 4});
    MeshInput b = box("rectangle", {1., 0.}, {3., 1.}, {8, 4});
    const auto joined = report<2>(scene_of<2>({a, b}));
    EXPECT_EQ(joined.n_cells, 48u);
    EXPECT_NEAR(joined.volume, 3., 1e-12);
    EXPECT_NEAR(joined.inner_face_area, 11 * 1. + 3 * 3., 1e-11);

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
    // by us, or by deal.II where it is built with checks
    for (const char *corners : {"0., 0. ; 0., 1. ; 1., 0. ; 1., 1. : false",
                                "0., 0. ; 1., 0. ; 0., 0. ; 1., 0. : false"}) {
      const std::string of_cell =
          problems_of<2>(scene_of(generator("general_cell", corners)));
      EXPECT_TRUE(((contains(of_cell, "is inverted") ||
                    contains(of_cell, "is degenerate")) &&
                   contains(of_cell, "Mesh: cell ") &&
                   contains(of_cell, " at (")) ||
                  contains(of_cell, "does not accept"))
          << of_cell;
    }
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
} // namespace mesh_checks::test_mesh
