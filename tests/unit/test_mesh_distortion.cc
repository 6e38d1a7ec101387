#include "mesh_checks.h"
#include "named_mesh_scene.h"

#include "mesh/lattice_mesh.h"
#include "mesh/level_mesh.h"

#include <cmath>
#include <set>
#include <string>
#include <vector>

// `distortion`: what moves, what stays, and that no cell turns over.

namespace mesh_checks::test_mesh_distortion
{
  namespace
  {
    const std::string plate =
        "set type = file\nset file = " + std::string(NSFD_SOURCE_DIR) +
        "/tests/meshes/plate_41_ascii.msh\n";

    using Places = std::set<std::array<double, 2>>;

    /** Of the boundary, of groups of faces, and between groups of cells. */
    Places places_that_stay(const Triangulation<2> &mesh)
    {
      Places result;
      for (const auto &cell : mesh.active_cell_iterators()) {
        if (cell->is_artificial())
          continue;
        for (const unsigned int f : cell->face_indices())
          if (cell->face(f)->at_boundary() ||
              cell->face(f)->manifold_id() != numbers::flat_manifold_id ||
              cell->neighbor(f)->material_id() != cell->material_id())
            for (const unsigned int v : {0u, 1u})
              result.insert(
                  {{cell->face(f)->vertex(v)[0], cell->face(f)->vertex(v)[1]}});
      }
      return result;
    }

    void expect_groups(const test::BuiltMesh<2> &mesh)
    {
      EXPECT_NEAR(mesh.volume("steel"), 1., 1e-12);
      EXPECT_NEAR(mesh.volume("glue"), 1., 1e-12);
      EXPECT_NEAR(mesh.boundary_area("all"), 6., 1e-12);
      EXPECT_NEAR(mesh.boundary_area("left end"), 1., 1e-12);
      EXPECT_NEAR(mesh.inner_area("seam"), 1., 1e-12);
      EXPECT_NEAR(mesh.inner_area("crack"), .5, 1e-12);
      Where between;
      between.kind = Where::Kind::between_groups;
      EXPECT_NEAR(mesh.inner_area(between), 1., 1e-12);
      EXPECT_GT(mesh_report(*mesh.triangulation).smallest_scaled_jacobian, 0.);
    }

    template <int dim>
    std::vector<double> volumes(const CoarseMesh<dim> &mesh)
    {
      std::vector<double> result;
      for (const auto &cell : mesh.cells)
        result.push_back(GridTools::cell_measure(
            mesh.vertices, make_array_view(cell.vertices)));
      return result;
    }

    /** A tenth of every cell is left, and something has moved. */
    template <int dim>
    void expect_no_cell_turned(const CoarseMesh<dim> &mesh)
    {
      for (const double share : {.3, .49, 2., 50.})
        for (const unsigned int seed : {1u, 2u, 3u}) {
          CoarseMesh<dim> distorted = mesh;
          distort(distorted, share, seed);
          const auto before = volumes(mesh), after = volumes(distorted);
          double sum = 0., moved = 0.;
          for (std::size_t c = 0; c < before.size(); ++c) {
            if (mesh.cells[c].vertices.size() == dim + 1) {
              EXPECT_GE(after[c], .1 * before[c] * (1. - 1e-12));
            }
            EXPECT_GT(after[c], 0.);
            sum += after[c] - before[c];
            moved = std::max(moved, std::abs(after[c] - before[c]));
          }
          EXPECT_NEAR(sum, 0., 1e-11);
          EXPECT_GT(moved, .01 * before[0]);
          std::vector<std::string> problems;
          check(distorted, problems);
          EXPECT_TRUE(problems.empty()) << problems.front();
        }
    }
  } // namespace

  TEST(MeshDistortion, GroupsOfAFileStay)
  {
    const test::BuiltMesh<2> straight(test::mesh_scene(2, plate));
    const Places stay = places_that_stay(*straight.triangulation);
    for (const std::string share : {"0.2", "0.49"}) {
      const test::BuiltMesh<2> mesh(
          test::mesh_scene(2, plate + "set distortion = " + share + "\n"));
      expect_groups(mesh);
      EXPECT_EQ(places_that_stay(*mesh.triangulation), stay);
      EXPECT_NE(mesh.inner_area("all"), straight.inner_area("all"));
      const test::BuiltMesh<2> other(test::mesh_scene(
          2, plate + "set seed = 2\nset distortion = " + share + "\n"));
      EXPECT_NE(mesh.inner_area("all"), other.inner_area("all"));
      // every rank has the cells of the whole mesh to the last bit
      build<2>(*mesh.input);
    }
  }

  TEST(MeshDistortion, GroupsStayThroughRefinementAndSplit)
  {
    for (const char *more :
         {"set refinements = 1\n", "set split = barycentric\n",
          "set split = barycentric\nset refinements = 1\n",
          "set split simplices = true\n",
          "set split simplices = true\nset refinements = 1\n"}) {
      SCOPED_TRACE(more);
      expect_groups(test::BuiltMesh<2>(
          test::mesh_scene(2, plate + "set distortion = 0.45\n" + more)));
    }
  }

  // The split cuts moved cells: all six parts have a sixth of the area.
  TEST(MeshDistortion, ComesBeforeTheSplit)
  {
    MeshInput mesh = cells_of_side_one("diagonal triangles", 2, 4);
    mesh.distortion = .3;
    std::multiset<double> whole;
    const auto distorted = vertices(*build<2>(scene_of(mesh)));
    for (const auto &[id, x] : distorted)
      whole.insert(.5 * std::abs((x[1] - x[0])[0] * (x[2] - x[0])[1] -
                                 (x[1] - x[0])[1] * (x[2] - x[0])[0]));
    mesh.split_barycentric = true;
    std::vector<std::string> problems;
    const auto cut = build_mesh<2>(scene_of(mesh), MPI_COMM_SELF, problems);
    ASSERT_TRUE(cut);
    std::multiset<double> parts;
    for (const auto &cell : cut->active_cell_iterators())
      parts.insert(6. * cell->measure());
    if (Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
      return; // `whole` has the cells of this rank
    ASSERT_EQ(parts.size(), 6 * whole.size());
    auto part = parts.begin();
    for (const double area : whole)
      for (unsigned int i = 0; i < 6; ++i, ++part)
        EXPECT_NEAR(*part, area, 1e-13);
  }

  TEST(MeshDistortion, NoCellTurnsOver)
  {
    std::vector<std::string> problems;
    const auto quads =
        lattice_mesh<2>(cells_of_side_one("rectangle", 2, 8), 0, problems);
    expect_no_cell_turned(quads);
    expect_no_cell_turned(cut_in_four(quads));
    expect_no_cell_turned(cut_along_diagonal(quads));
    const auto hexes =
        lattice_mesh<3>(cells_of_side_one("brick", 3, 4), 0, problems);
    expect_no_cell_turned(hexes);
    expect_no_cell_turned(cut_along_diagonal(hexes));
    EXPECT_TRUE(problems.empty());
  }

  // Where nothing is squeezed, nothing is halved.
  TEST(MeshDistortion, MovesAreProportionalToTheShare)
  {
    std::vector<std::string> problems;
    const auto quads =
        lattice_mesh<2>(cells_of_side_one("rectangle", 2, 8), 0, problems);
    auto less = quads, more = quads;
    distort(less, .1, 1);
    distort(more, .2, 1);
    for (std::size_t v = 0; v < quads.vertices.size(); ++v)
      EXPECT_LT((more.vertices[v] - quads.vertices[v] -
                 2. * (less.vertices[v] - quads.vertices[v]))
                    .norm(),
                1e-14);
  }

  TEST(MeshDistortion, FacesBetweenBodiesStay)
  {
    SceneInput scene =
        scene_of<2>({box("rectangle", {0., 0.}, {1., 1.}, {4, 4}),
                     box("rectangle", {1., 0.}, {3., 1.}, {8, 4})});
    const double straight = report<2>(scene).inner_face_area;
    scene.mesh.distortion = .3;
    EXPECT_NE(report<2>(scene).inner_face_area, straight);
    const auto mesh = build<2>(scene);
    for (const auto &cell : mesh->active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int f : cell->face_indices())
          if (!cell->face(f)->at_boundary() &&
              cell->neighbor(f)->material_id() != cell->material_id())
            for (const unsigned int v : {0u, 1u}) {
              EXPECT_EQ(cell->face(f)->vertex(v)[0], 1.);
            }
  }

  // Twelve prisms around an axis, in two layers: the vertex in the middle is
  // the only one inside, and moves before they are cut into hexes.
  TEST(MeshDistortion, PrismsMoveAndAreSplit)
  {
    std::string nodes, elements;
    for (unsigned int layer = 0; layer < 3; ++layer)
      for (unsigned int i = 0; i < 7; ++i) {
        const double angle = i * numbers::PI / 3.;
        nodes += std::to_string(7 * layer + i + 1) + " " +
                 (i == 6 ? "0 0"
                         : std::to_string(std::cos(angle)) + " " +
                               std::to_string(std::sin(angle))) +
                 " " + std::to_string(layer) + "\n";
      }
    for (unsigned int layer = 0; layer < 2; ++layer)
      for (unsigned int i = 0; i < 6; ++i) {
        elements += std::to_string(6 * layer + i + 1) + " 6 2 1 1";
        for (const unsigned int l : {layer, layer + 1})
          for (const unsigned int v : {6u, i, (i + 1) % 6})
            elements += " " + std::to_string(7 * l + v + 1);
        elements += "\n";
      }
    const test::TemporaryFile file(
        "prisms.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n21\n" +
                          nodes + "$EndNodes\n$Elements\n12\n" + elements +
                          "$EndElements\n");
    const std::string split = "set split simplices = true\n";
    const test::BuiltMesh<3> straight(test::mesh_scene(3, file.entries(split))),
        distorted(test::mesh_scene(
            3, file.entries(split + "set distortion = 0.4\n")));
    ASSERT_TRUE(distorted.triangulation);
    EXPECT_EQ(distorted.triangulation->n_global_active_cells(), 72u);
    EXPECT_NEAR(distorted.volume("all"), straight.volume("all"), 1e-12);
    EXPECT_NEAR(distorted.boundary_area("all"), straight.boundary_area("all"),
                1e-12);
    EXPECT_NE(distorted.inner_area("all"), straight.inner_area("all"));
    EXPECT_GT(mesh_report(*distorted.triangulation).smallest_scaled_jacobian,
              0.);
  }
} // namespace mesh_checks::test_mesh_distortion
