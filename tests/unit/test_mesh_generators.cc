#include "mesh_checks.h"

namespace mesh_checks::test_mesh_generators
{
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
    for (const std::string &name : mesh_type_names())
      if (find_mesh_type(name)->has_ids()) {
        EXPECT_TRUE(std::any_of(
            std::begin(generator_rows), std::end(generator_rows),
            [&](const GeneratorRow &row) { return name == row.name; }))
            << "no row for the generator " << name;
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
} // namespace mesh_checks::test_mesh_generators
