#include "mesh/coarse_mesh.h"
#include "mesh/isotropic.h"
#include "mesh_checks.h"
#include "named_mesh_scene.h"

#include <deal.II/base/mpi.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

// `type = isotropic`: nodes by Lloyd, triangles by Delaunay, cut in six.

namespace mesh_checks::test_isotropic_mesh
{
  namespace
  {
    PlaneOutline rectangle(const double width, const double height)
    {
      std::vector<std::string> problems;
      const PlaneOutline outline = outline_of(
          {{{{0., 0.}}, {{width, 0.}}, {{width, height}}, {{0., height}}}, {}},
          problems);
      EXPECT_TRUE(problems.empty());
      return outline;
    }

    NamedMesh filled(const PlaneOutline &outline,
                     const IsotropicRequest &request)
    {
      NamedMesh mesh;
      std::vector<std::string> problems;
      fill_isotropically(outline, request, mesh, problems);
      EXPECT_TRUE(problems.empty()) << problems.front();
      return mesh;
    }

    IsotropicRequest of_size(const double size, const unsigned int seed = 1)
    {
      IsotropicRequest request;
      request.size.factor = size;
      request.seed = seed;
      request.iterations = 50;
      return request;
    }

    std::vector<Point<2>> corners_of(const NamedMesh &mesh, const std::size_t c)
    {
      std::vector<Point<2>> corners;
      for (unsigned int i = 0; i < 3; ++i) {
        const double *x = mesh.coordinates.data() + 3 * mesh.cells.begin(c)[i];
        corners.emplace_back(x[0], x[1]);
      }
      return corners;
    }

    double area(const std::vector<Point<2>> &x)
    {
      return .5 * ((x[1][0] - x[0][0]) * (x[2][1] - x[0][1]) -
                   (x[1][1] - x[0][1]) * (x[2][0] - x[0][0]));
    }

    std::string errors(const std::string &mesh)
    {
      return test::errors_of(
          test::mesh_scene(2, "set type = isotropic\n" + mesh));
    }

    void expect_error(const std::string &mesh, const std::string &part)
    {
      const std::string text = errors(mesh);
      EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
    }
  } // namespace

  // A triangle of side h has sqrt(3)/4 h^2; one node more makes two more, so
  // that the number is right to one node. Lloyd's nodes leave angles of 30
  // degrees and edges of two thirds of the size.
  TEST(IsotropicMesh, FillsARectangle)
  {
    for (const unsigned int seed : {1u, 2u, 3u}) {
      const NamedMesh mesh = filled(rectangle(30., 20.), of_size(1., seed));
      double sum = 0., smallest_angle = 180., shortest = 1e300;
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const auto corners = corners_of(mesh, c);
        const CellShape shape = cell_shape(corners);
        sum += area(corners);
        EXPECT_GT(area(corners), 0.);
        smallest_angle = std::min(smallest_angle, shape.smallest_angle);
        shortest = std::min(shortest, shape.shortest_edge);
      }
      EXPECT_NEAR(sum, 600., 1e-10);
      EXPECT_NEAR(double(mesh.cells.size()), 600. * 4. / std::sqrt(3.), 2.);
      EXPECT_GT(smallest_angle, 22.);
      EXPECT_GT(shortest, .55);
    }
  }

  TEST(IsotropicMesh, HasTheNumberOfCellsThatIsAskedFor)
  {
    IsotropicRequest request = of_size(1.);
    request.n_triangles = 1000.;
    // in any unit
    for (const double scale : {1., 1e-6, 1e3})
      EXPECT_NEAR(
          double(
              filled(rectangle(3. * scale, 2. * scale), request).cells.size()),
          1000., 2.);
  }

  TEST(IsotropicMesh, IsThatOfItsSeed)
  {
    const NamedMesh first = filled(rectangle(10., 10.), of_size(1., 1)),
                    again = filled(rectangle(10., 10.), of_size(1., 1)),
                    other = filled(rectangle(10., 10.), of_size(1., 2));
    EXPECT_EQ(first.coordinates, again.coordinates);
    EXPECT_EQ(first.cells.vertices, again.cells.vertices);
    // the corners of the square are common, no other node is
    std::set<std::array<double, 2>> places;
    for (const NamedMesh *mesh : {&first, &other})
      for (std::size_t v = 0; v < mesh->n_vertices(); ++v)
        places.insert(
            {{mesh->coordinates[3 * v], mesh->coordinates[3 * v + 1]}});
    EXPECT_EQ(places.size(), first.n_vertices() + other.n_vertices() - 4);
  }

  // h = 1 + x/30: triangles in a strip are its height times the integral of
  // 4/sqrt(3)/h^2. Lloyd's nodes are where the density is right up to a few
  // hundredths.
  TEST(IsotropicMesh, FollowsTheSize)
  {
    IsotropicRequest request = of_size(1.);
    request.size.formula = Expression(
        [](const double x, double, double, double) { return 1. + x / 30.; },
        "1 + x/30", false);
    const NamedMesh mesh = filled(rectangle(60., 30.), request);
    for (const double from : {0., 20., 40.}) {
      const double to = from + 20.;
      unsigned int count = 0;
      for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const auto corners = corners_of(mesh, c);
        const double x = (corners[0][0] + corners[1][0] + corners[2][0]) / 3.;
        count += x >= from && x < to;
      }
      const double expected = 30. * 4. / std::sqrt(3.) * 30. *
                              (1. / (1. + from / 30.) - 1. / (1. + to / 30.));
      EXPECT_NEAR(count / expected, 1., .06) << from;
    }
  }

  TEST(IsotropicMesh, KeepsItsBoundaryAndItsLines)
  {
    // a notch from the left side, and two lines that cross
    const test::BuiltMesh<2> mesh(test::mesh_scene(
        2, "set type = isotropic\nset upper corner = 30, 20\nset size = 1\n"
           "set lines = notch: [0, 10], [12, 10]; cross: [15, 5], [25, 15]; "
           "cross: [15, 15], [25, 5]\n"));
    EXPECT_NEAR(mesh.inner_area("notch"), 12., 1e-12);
    EXPECT_NEAR(mesh.inner_area("cross"), 20. * std::sqrt(2.), 1e-11);
    EXPECT_EQ(mesh.boundary_area("notch"), 0.);
    EXPECT_NEAR(mesh.boundary_area("all"), 100., 1e-11);
    EXPECT_NEAR(mesh_report(*mesh.triangulation).volume, 600., 1e-9);
    // six of each triangle
    EXPECT_EQ(mesh.triangulation->n_global_active_cells(),
              6 * mesh.named().cells.size());
  }

  // Where a straight line has a point, as where a crack ends, there is a node.
  TEST(IsotropicMesh, HasNodesWhereStraightLinesHavePoints)
  {
    const test::BuiltMesh<2> mesh(test::mesh_scene(
        2, "set type = isotropic\nset upper corner = 30, 20\nset size = 1\n"
           "set split = none\n"
           "set lines = crack: [0, 10], [12.3456, 10]; rest: [12.3456, 10], "
           "[30, 10]; seam: [3, 5], [7.654, 5], [20, 5]\n"));
    EXPECT_NEAR(mesh.inner_area("crack"), 12.3456, 1e-12);
    double nearest = 1.;
    for (const auto &x : mesh.triangulation->get_vertices())
      nearest = std::min(nearest, std::hypot(x[0] - 7.654, x[1] - 5.));
    // on whichever rank
    EXPECT_LT(dealii::Utilities::MPI::min(nearest, MPI_COMM_WORLD), 1e-12);
  }

  TEST(IsotropicMesh, FillsAPolygon)
  {
    // not convex; three quads of each triangle
    const std::string shape = "set type = isotropic\n"
                              "set corners = [0, 0], [4, 0], [4, 1], [1, 1], "
                              "[1, 3], [0, 3]\nset size = 0.2\n";
    const test::BuiltMesh<2> six(test::mesh_scene(2, shape)),
        three(test::mesh_scene(2, shape + "set split simplices = true\n")),
        uncut(test::mesh_scene(2, shape + "set split = none\n"));
    for (const auto *mesh : {&six, &three, &uncut}) {
      EXPECT_NEAR(mesh_report(*mesh->triangulation).volume, 6., 1e-12);
      EXPECT_NEAR(mesh->boundary_area("all"), 14., 1e-12);
    }
    const auto n = uncut.triangulation->n_global_active_cells();
    EXPECT_EQ(six.triangulation->n_global_active_cells(), 6 * n);
    EXPECT_EQ(three.triangulation->n_global_active_cells(), 3 * n);
  }

  // Groups of cells, their common border, boundary faces and an embedded crack.
  TEST(IsotropicMesh, FillsTheOutlineOfAFile)
  {
    for (const char *file : {"plate_41_ascii.msh", "plate.geo"}) {
      const test::BuiltMesh<2> mesh(test::mesh_scene(
          2,
          "set type = isotropic\nset file = " + std::string(NSFD_SOURCE_DIR) +
              "/tests/meshes/" + file + "\nset size = 0.1\n"));
      EXPECT_NEAR(mesh.volume("steel"), 1., 1e-12) << file;
      EXPECT_NEAR(mesh.volume("glue"), 1., 1e-12);
      EXPECT_NEAR(mesh.boundary_area("left end"), 1., 1e-12);
      EXPECT_NEAR(mesh.boundary_area("right end"), 1., 1e-12);
      EXPECT_NEAR(mesh.inner_area("seam"), 1., 1e-12);
      EXPECT_NEAR(mesh.inner_area("crack"), .5, 1e-12);
      EXPECT_NEAR(double(mesh.named().cells.size()), 200. * 4. / std::sqrt(3.),
                  2.);
    }
  }

  // Regular tetrahedra of side h have h^3 / (6 sqrt(2)); Lloyd's nodes make
  // about as many. Flat ones, of less than a quarter of that height, are gone.
  TEST(IsotropicMesh, FillsABrick)
  {
    const std::string brick = "set type = isotropic\nset lower corner = -1, 0, "
                              "2\nset upper corner = 5, 4, 5\nset size = 1\n";
    const test::BuiltMesh<3> cut(test::mesh_scene(3, brick)),
        uncut(test::mesh_scene(3, brick + "set split = none\n")),
        other(test::mesh_scene(3, brick + "set seed = 2\n")),
        counted(test::mesh_scene(3, "set type = isotropic\n"
                                    "set upper corner = 2, 2, 2\n"
                                    "set cells = 24000\n"));
    for (const auto *mesh : {&cut, &uncut, &other}) {
      EXPECT_NEAR(mesh_report(*mesh->triangulation).volume, 72., 1e-11);
      EXPECT_NEAR(mesh->boundary_area("all"), 108., 1e-11);
    }
    const auto n = uncut.triangulation->n_global_active_cells();
    EXPECT_EQ(cut.triangulation->n_global_active_cells(), 24 * n);
    EXPECT_NEAR(n / (72. * 6. * std::sqrt(2.)), 1., .05);
    EXPECT_NEAR(counted.triangulation->n_global_active_cells() / 24000., 1.,
                .05);
    EXPECT_GT(mesh_report(*uncut.triangulation).smallest_height,
              .25 * std::sqrt(2. / 3.));
    EXPECT_NE(cut.named().coordinates, other.named().coordinates);
  }

  TEST(IsotropicMesh, HalvesItsSize)
  {
    const std::string shape =
        "set type = isotropic\nset upper corner = 3, 2\nset cells = 600\n";
    const test::BuiltMesh<2> once(test::mesh_scene(2, shape)),
        halved(test::mesh_scene(2, shape + "set refinements = 1\n"));
    EXPECT_NEAR(double(once.triangulation->n_global_active_cells()), 600., 12.);
    EXPECT_NEAR(double(halved.triangulation->n_global_active_cells()), 2400.,
                12.);
  }

  TEST(IsotropicMesh, SaysWhatIsWrong)
  {
    const std::string box = "set upper corner = 3, 2\n";
    expect_error(box, "neither `size` nor `cells`");
    expect_error(box + "set size = 1\nset cells = 7\n", "say the same");
    expect_error("set size = 1\n", "upper corner");
    expect_error("set upper corner = -1, 2\nset size = 1\n",
                 "must be greater than");
    expect_error(box + "set size = x - 1\n", "`size` is -1 at (0, 0, 0)");
    expect_error(box + "set size = 1 + t\n", "depends on the time");
    expect_error(box + "set size = 1e-6\n", "write a larger `size`");
    expect_error(box + "set size = 1\nset corners = [0, 0], [1, 0], [0, 1]\n",
                 "`corners` is the boundary");
    expect_error("set size = 1\nset corners = [0, 0], [1, 0], 0, 1\n",
                 "`0` is no point");
    expect_error("set size = 1\nset corners = [0, 0], [1, 0]\n",
                 "fewer than three corners");
    expect_error("set size = 1\nset corners = [0, 0], [1, 1], [1, 0], [0, 1]\n",
                 "crosses itself at (0.5, 0.5)");
    expect_error("set size = 1\nset corners = [0, 0], [0, 0], [1, 0], [0, 1]\n",
                 "at one place");
    expect_error(box + "set size = 1\nset lines = [0, 1], [1, 1]\n",
                 "has no name");
    expect_error(box + "set size = 1\nset lines = notch: [0, 1]\n",
                 "one point only");
    expect_error(box + "set size = 1\nset lines = notch: [1, 1], [4, 1]\n",
                 "line `notch` has a point outside");
    expect_error(box + "set size = 1\nset file = a.geo\n", "those of the file");
    expect_error(box + "set size = 1\nset element size = 1\n",
                 "belong to a `file`");
    const auto in_space = [](const std::string &mesh) {
      return test::errors_of(
          test::mesh_scene(3, "set type = isotropic\n" + mesh));
    };
    for (const auto &[lines, part] :
         {std::pair("set size = 1\n", "upper corner"),
          std::pair("set upper corner = 1, 1, 1\n", "neither `size`"),
          std::pair("set upper corner = 1, 1, 1\nset size = 1e-9\n",
                    "write a larger `size`"),
          std::pair("set upper corner = 1, 1, 1\nset size = 1\n"
                    "set file = a.geo\n",
                    "the boundary is a brick")})
      EXPECT_NE(in_space(lines).find(part), std::string::npos)
          << part << "\n"
          << in_space(lines);
    // all of them at once
    const std::string text = errors("set size = 0\nset seed = -1\n"
                                    "set relaxation = x\nset spilt = none\n");
    for (const char *part : {"upper corner", "seed", "relaxation", "spilt"})
      EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
} // namespace mesh_checks::test_isotropic_mesh
