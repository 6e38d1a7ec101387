#include "mesh_checks.h"
#include "mesh_quality/crack_network.h"
#include "named_mesh_scene.h"

#include <cmath>
#include <string>

// How much longer than the straight one the shortest way along faces is.

namespace mesh_checks::test_path_ratio
{
  namespace
  {
    PathRatio ratio_of(const std::string &mesh)
    {
      InputErrors errors;
      const auto input =
          read_scene_text(test::mesh_scene(2, mesh), "test.prm", {}, errors);
      EXPECT_TRUE(input) << errors.report();
      std::vector<std::string> problems, warnings;
      const auto triangulation = build_mesh<2>(*input, MPI_COMM_SELF, problems);
      const MeshGroups<2> groups(*input, *triangulation);
      const auto materials = material_indices<2>(*input, groups, *triangulation,
                                                 problems, warnings);
      EXPECT_TRUE(problems.empty());
      return path_ratio(
          crack_network(*input, *triangulation, groups, materials));
    }

    CutRatio cut_of(const std::string &mesh)
    {
      InputErrors errors;
      const auto input =
          read_scene_text(test::mesh_scene(3, mesh), "test.prm", {}, errors);
      EXPECT_TRUE(input) << errors.report();
      std::vector<std::string> problems, warnings;
      const auto triangulation = build_mesh<3>(*input, MPI_COMM_SELF, problems);
      const MeshGroups<3> groups(*input, *triangulation);
      const auto materials = material_indices<3>(*input, groups, *triangulation,
                                                 problems, warnings);
      EXPECT_TRUE(problems.empty());
      return cut_ratio(cell_network(*input, *triangulation, groups, materials));
    }

    void expect_directions(const PathRatio &ratio, const double low,
                           const double high)
    {
      EXPECT_EQ(ratio.n_pairs, 240u);
      for (const auto &direction : ratio.directions) {
        // the mean of ten pairs
        const double error = 3. * direction.scatter / std::sqrt(10.);
        EXPECT_GT(direction.mean, low - error) << direction.angle;
        EXPECT_LT(direction.mean, high + error) << direction.angle;
      }
    }
  } // namespace

  // Along sides of squares a way is |cos| + |sin| times as long. Points are
  // half a spacing from where they are looked for at most in each direction,
  // which turns a pair by 1/43.
  TEST(PathRatio, OfSquaresIsThatOfTheirSides)
  {
    const PathRatio ratio =
        ratio_of("set upper corner = 60, 60\nset cells = 60, 60\n");
    EXPECT_EQ(ratio.n_pairs, 240u);
    for (const auto &direction : ratio.directions) {
      const double angle = direction.angle * numbers::PI / 180.;
      EXPECT_NEAR(direction.mean,
                  std::abs(std::cos(angle)) + std::abs(std::sin(angle)),
                  1. / 43.);
    }
    // 4/pi by the rule of midpoints in 24 directions, which is exact to 1e-3
    EXPECT_NEAR(ratio.mean, 4. / numbers::PI, 5e-3);
    EXPECT_NEAR(ratio.distance, 43. * ratio.spacing, 1e-12 * ratio.distance);
  }

  // Both diagonals in each square: the octagonal norm,
  // cos + (sqrt(2) - 1) sin for angles below 45 degrees; its mean is
  // 8/pi (sqrt(2) - 1) = 1.0548.
  TEST(PathRatio, OfCrossedTrianglesIsThatOfTheirSidesAndDiagonals)
  {
    const PathRatio ratio = ratio_of("set type = crossed triangles\n"
                                     "set upper corner = 60, 60\n"
                                     "set cells = 60, 60\n");
    EXPECT_NEAR(ratio.mean, 8. / numbers::PI * (std::sqrt(2.) - 1.), 5e-3);
    for (const auto &direction : ratio.directions) {
      const double folded =
          std::fmod(direction.angle, 90.) * numbers::PI / 180.;
      const double angle = std::min(folded, numbers::PI / 2. - folded);
      EXPECT_NEAR(direction.mean,
                  std::cos(angle) + (std::sqrt(2.) - 1.) * std::sin(angle),
                  1. / 43.);
    }
  }

  // Tables of isotropic meshes: 1.048 by direction 1.039 to 1.054 for Delaunay
  // triangles of Lloyd's nodes, 1.018 (1.016 to 1.020) once they are cut in
  // six.
  TEST(PathRatio, OfIsotropicMeshesKnowsNoDirection)
  {
    const std::string square = "set type = isotropic\n"
                               "set upper corner = 60, 60\nset size = 1\n";
    for (const char *seed : {"1", "2"}) {
      const std::string mesh = square + "set seed = " + seed + "\n";
      const PathRatio uncut = ratio_of(mesh + "set split = none\n");
      EXPECT_NEAR(uncut.mean, 1.048, .003);
      expect_directions(uncut, 1.039, 1.054);
      const PathRatio cut = ratio_of(mesh);
      EXPECT_LE(cut.mean, 1.020);
      EXPECT_GT(cut.mean, 1.015);
      expect_directions(cut, cut.mean - .003, cut.mean + .003);
    }
  }

  // The faces of cubes that a plane pushes apart have |n_x| + |n_y| + |n_z|
  // times its area. A cell more or less along its edge is what 1/N leaves.
  TEST(CutRatio, OfCubesIsThatOfTheirSides)
  {
    const CutRatio ratio =
        cut_of("set upper corner = 18, 18, 18\nset cells = 18, 18, 18\n");
    double mean = 0.;
    for (const auto &direction : ratio.directions) {
      const auto &n = direction.normal;
      mean += (std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2])) /
              double(ratio.directions.size());
    }
    EXPECT_EQ(ratio.directions.size(), 20u);
    EXPECT_NEAR(ratio.mean, mean, 1. / 18.);
    EXPECT_NEAR(ratio.in_this_box, mean, 2. / 18.);
  }

  // Delaunay tetrahedra of Lloyd's nodes, and the same cut in twenty-four: half
  // of the excess, up to the tenth by which seeds differ in so small a box.
  TEST(CutRatio, OfTetrahedraThatAreCutIsHalfOfThatBefore)
  {
    const std::string box = "set type = isotropic\n"
                            "set upper corner = 7, 7, 7\nset size = 1\n";
    const CutRatio uncut = cut_of(box + "set split = none\n"),
                   cut = cut_of(box);
    EXPECT_LE(cut.mean - 1., .55 * (uncut.mean - 1.));
    EXPECT_GT(cut.mean, 1.);
  }

  // A line of faces that may break: one way, and its own length.
  TEST(PathRatio, LooksAtFacesThatMayBreakOnly)
  {
    InputErrors errors;
    const auto input = read_scene_text(
        "subsection Mesh\n  set upper corner = 20, 20\n  set cells = 20, 20\n"
        "end\nsubsection Material: bulk\n  set Young modulus = 1\n"
        "  set Poisson ratio = 0.3\n  set density = 1\nend\n"
        "subsection Interface: line\n  set where = abs(y - 10) < 0.1\n"
        "  set law = camacho-ortiz\n  set strength = 1e-3\n"
        "  set toughness = 1e-3\nend\n"
        "subsection Interface: elsewhere\n  set law = joined\nend\n"
        "subsection Time\n  set end = 1\n  set step = 0.01\nend\n",
        "test.prm", {}, errors);
    ASSERT_TRUE(input) << errors.report();
    std::vector<std::string> problems, warnings;
    const auto triangulation = build_mesh<2>(*input, MPI_COMM_SELF, problems);
    const MeshGroups<2> groups(*input, *triangulation);
    const auto materials =
        material_indices<2>(*input, groups, *triangulation, problems, warnings);
    const CrackNetwork network =
        crack_network(*input, *triangulation, groups, materials);
    EXPECT_EQ(network.faces.size(), 20u);
    EXPECT_NEAR(network.area, 400., 1e-10);
  }
} // namespace mesh_checks::test_path_ratio
