// What a file leaves to be put in order, and how a scene names its groups.

#include "named_mesh_scene.h"

#include <cmath>
#include <set>

using namespace nsfd;
using namespace nsfd::test;

namespace test_mesh_groups
{
  const std::string plate =
      "set type = file\nset file = " + std::string(NSFD_SOURCE_DIR) +
      "/tests/meshes/plate_41_ascii.msh\n";

  bool has(const std::string &text, const std::string &part)
  {
    return text.find(part) != std::string::npos;
  }

  /** Version 2.2: `nodes` and `elements` as they stand in such a file. */
  std::string msh(const std::vector<std::string> &nodes,
                  const std::vector<std::string> &elements)
  {
    std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" +
                       std::to_string(nodes.size()) + "\n";
    for (std::size_t i = 0; i < nodes.size(); ++i)
      text += std::to_string(i + 1) + " " + nodes[i] + "\n";
    text += "$EndNodes\n$Elements\n" + std::to_string(elements.size()) + "\n";
    for (std::size_t i = 0; i < elements.size(); ++i)
      text += std::to_string(i + 1) + " " + elements[i] + "\n";
    return text + "$EndElements\n";
  }

  const std::vector<std::string> six_nodes = {"0 0 0", "1 0 0", "2 0 0",
                                              "0 1 0", "1 1 0", "2 1 0"};

  const std::string *note_with(const NamedMesh &mesh, const std::string &part)
  {
    for (const std::string &note : mesh.notes)
      if (has(note, part))
        return &note;
    return nullptr;
  }

  std::string interface(const std::string &where)
  {
    return "subsection Interface: first\n  set where = " + where +
           "\n  set law = rigid\nend\n";
  }

  std::string boundary(const std::string &where)
  {
    return "subsection Boundary: first\n  set where = " + where +
           "\n  set velocity x = 1\nend\n";
  }

  TEST(NamedMesh, ClockwiseCellsAreTurned)
  {
    const TemporaryFile file(
        "turned.msh", msh(six_nodes, {"3 2 1 1 1 4 5 2", "3 2 1 1 2 3 6 5"}));
    const BuiltMesh<2> mesh(mesh_scene(2, file.entries()));
    ASSERT_TRUE(mesh.triangulation);
    EXPECT_NEAR(mesh.volume("all"), 2., 1e-14);
    ASSERT_TRUE(note_with(mesh.named(), "1 of 2 cells had a negative area"));
  }

  TEST(NamedMesh, AllShapesInSpaceAreTurned)
  {
    // tetrahedron, prism and hex, each mirrored
    const TemporaryFile tet("tet.msh", msh({"0 0 0", "1 0 0", "0 1 0", "0 0 1"},
                                           {"4 2 1 1 1 3 2 4"}));
    const TemporaryFile prism(
        "prism.msh", msh({"0 0 0", "1 0 0", "0 1 0", "0 0 1", "1 0 1", "0 1 1"},
                         {"6 2 1 1 4 5 6 1 2 3"}));
    const TemporaryFile hex("hex.msh", msh({"0 0 0", "1 0 0", "1 1 0", "0 1 0",
                                            "0 0 1", "1 0 1", "1 1 1", "0 1 1"},
                                           {"5 2 1 1 5 6 7 8 1 2 3 4"}));
    const std::string split = "set split simplices = true\n";
    const auto volume = [&](const TemporaryFile &file) {
      const BuiltMesh<3> mesh(mesh_scene(3, file.entries(split)));
      EXPECT_TRUE(note_with(mesh.named(), "negative volume"));
      return mesh.volume("all");
    };
    EXPECT_NEAR(volume(tet), 1. / 6., 1e-14);
    EXPECT_NEAR(volume(prism), .5, 1e-14);
    EXPECT_NEAR(volume(hex), 1., 1e-14);
  }

  TEST(NamedMesh, MixedShapesAreRefusedOrSplit)
  {
    const TemporaryFile file("mixed.msh",
                             msh(six_nodes, {"3 2 1 1 1 2 5 4", "2 2 2 2 2 3 6",
                                             "2 2 2 2 2 6 5", "1 2 7 7 2 5"}));
    const std::string errors = errors_of(mesh_scene(2, file.entries()));
    EXPECT_TRUE(has(errors, "2 triangles, 1 quads")) << errors;
    EXPECT_TRUE(has(errors, "set split simplices = true")) << errors;
    const BuiltMesh<2> mesh(
        mesh_scene(2, file.entries("set split simplices = true")));
    ASSERT_TRUE(mesh.triangulation);
    EXPECT_EQ(mesh.triangulation->n_global_active_cells(), 10u);
    EXPECT_NEAR(mesh.volume("1"), 1., 1e-14);
    EXPECT_NEAR(mesh.volume("2"), 1., 1e-14);
    EXPECT_NEAR(mesh.inner_area("7"), 1., 1e-14);
  }

  TEST(NamedMesh, UnusedVerticesAndFreeElementsGo)
  {
    auto nodes = six_nodes;
    nodes.push_back("5 5 0");
    // a line across a quad, and one from nowhere
    const TemporaryFile file("loose.msh",
                             msh(nodes, {"3 2 1 1 1 2 5 4", "3 2 1 1 2 3 6 5",
                                         "1 2 7 7 1 5", "1 2 7 7 6 7"}));
    const BuiltMesh<2> mesh(mesh_scene(2, file.entries()));
    EXPECT_EQ(mesh.named().n_vertices(), 6u);
    EXPECT_TRUE(note_with(mesh.named(), "on no cell"));
    EXPECT_TRUE(note_with(mesh.named(), "no face of a cell"));
  }

  TEST(NamedMesh, ElementInTwoGroupsIsOneElement)
  {
    const TemporaryFile file(
        "twice.msh", msh(six_nodes, {"3 2 1 1 1 2 5 4", "3 2 2 1 1 2 5 4",
                                     "3 2 2 2 2 3 6 5"}));
    const BuiltMesh<2> mesh(mesh_scene(2, file.entries()));
    EXPECT_NEAR(mesh.volume("all"), 2., 1e-14);
    EXPECT_NEAR(mesh.volume("1"), 1., 1e-14);
    EXPECT_NEAR(mesh.volume("2"), 2., 1e-14);
  }

  TEST(NamedMesh, CoincidentVerticesAreReportedOrJoined)
  {
    const std::vector<std::string> nodes = {"0 0 0", "1 0 0", "1 1 0", "0 1 0",
                                            "1 0 0", "2 0 0", "2 1 0", "1 1 0"};
    const TemporaryFile file(
        "crack.msh", msh(nodes, {"3 2 1 1 1 2 3 4", "3 2 1 1 5 6 7 8"}));
    const BuiltMesh<2> apart(mesh_scene(2, file.entries()));
    const std::string *note = note_with(apart.named(), "merge vertices");
    ASSERT_TRUE(note);
    EXPECT_TRUE(has(*note, "2 vertices")) << *note;
    EXPECT_TRUE(has(*note, "1 pairs of faces")) << *note;
    EXPECT_EQ(apart.inner_area("all"), 0.);
    const BuiltMesh<2> joined(
        mesh_scene(2, file.entries("set merge vertices = true")));
    EXPECT_NEAR(joined.inner_area("all"), 1., 1e-14);
    EXPECT_EQ(joined.named().n_vertices(), 6u);
  }

  TEST(NamedMesh, BadCellsAreRefusedWithTheirPlace)
  {
    const auto problem = [](const TemporaryFile &file) {
      InputErrors errors;
      const auto input = read_scene_text(mesh_scene(2, file.entries()),
                                         "test.prm", {}, errors);
      if (!input)
        return errors.report();
      std::vector<std::string> problems;
      build_mesh<2>(*input, MPI_COMM_WORLD, problems);
      return problems.empty() ? std::string() : problems.front();
    };
    // sides that cross
    const TemporaryFile bow(
        "bow.msh", msh(six_nodes, {"3 2 1 1 1 2 4 5", "3 2 1 1 2 3 6 5"}));
    EXPECT_TRUE(has(problem(bow), "(0.5, 0.5)")) << problem(bow);
    const TemporaryFile flat(
        "flat.msh", msh({"0 0 0", "1 0 0", "2 0 0"}, {"2 2 1 1 1 2 3"}));
    EXPECT_TRUE(has(problem(flat), "degenerate")) << problem(flat);
    const TemporaryFile tilted(
        "tilted.msh", msh({"0 0 0", "1 0 1", "0 1 0"}, {"2 2 1 1 1 2 3"}));
    EXPECT_TRUE(has(problem(tilted), "not in a plane")) << problem(tilted);
    const TemporaryFile three(
        "three.msh",
        msh(six_nodes, {"2 2 1 1 1 2 4", "2 2 1 1 1 2 5", "2 2 1 1 1 2 6"}));
    EXPECT_TRUE(has(problem(three), "three cells meet")) << problem(three);
  }

  TEST(NamedMesh, NamesThatTheMeshLacks)
  {
    const std::string seam = errors_of(mesh_scene(2, plate, interface("saem")));
    EXPECT_TRUE(has(seam, "the mesh `file` has no such group")) << seam;
    EXPECT_TRUE(has(seam, "did you mean `seam`?")) << seam;
    const std::string far = errors_of(mesh_scene(2, plate, boundary("xyzzyx")));
    EXPECT_TRUE(has(far, "its groups are steel, glue, left end")) << far;
    const std::string words =
        errors_of(mesh_scene(2, plate, boundary("rihgt end")));
    EXPECT_TRUE(has(words, "did you mean `right end`?")) << words;
    EXPECT_TRUE(
        has(errors_of(mesh_scene(2, plate, boundary("99"))), "no such group"));
    EXPECT_TRUE(has(errors_of(mesh_scene(2, plate, boundary("seam"))),
                    "inside the mesh, not on its boundary"));
    EXPECT_TRUE(has(errors_of(mesh_scene(2, plate, interface("left end"))),
                    "this group is on the boundary"));
    EXPECT_TRUE(has(errors_of(mesh_scene(
                        2, plate, interface("between groups [steel, gleu]"))),
                    "did you mean `glue`?"));
    EXPECT_EQ(errors_of(mesh_scene(2, plate,
                                   interface("between groups [steel, glue]"))),
              "");
    // sides and expressions go on working
    EXPECT_EQ(errors_of(mesh_scene(2, plate, boundary("left"))), "");
    // a block has the group of its name, unless it says otherwise
    EXPECT_EQ(errors_of(mesh_scene(2, plate,
                                   "subsection Boundary: left end\n"
                                   "  set velocity x = 1\nend\n")),
              "");
    EXPECT_TRUE(has(errors_of(mesh_scene(2, plate,
                                         "subsection Boundary: far end\n"
                                         "  set velocity x = 1\nend\n")),
                    "`where` is missing"));
    EXPECT_EQ(errors_of(mesh_scene(2, plate, boundary("x < 1e-6"))), "");
  }

  TEST(NamedMesh, UnreadableMeshIsTheOnlyError)
  {
    const std::string errors =
        errors_of(mesh_scene(2, "set type = file\nset file = none.msh\n",
                             interface("seam") + boundary("left end") +
                                 boundary("7").replace(21, 5, "other")));
    EXPECT_TRUE(has(errors, "there is no file `none.msh`")) << errors;
    EXPECT_FALSE(has(errors, "group")) << errors;
  }

  TEST(NamedMesh, BetweenGroups)
  {
    const BuiltMesh<2> mesh(mesh_scene(2, plate));
    Where where;
    where.kind = Where::Kind::between_groups;
    EXPECT_NEAR(mesh.inner_area(where), 1., 1e-12);
    where.materials = {"glue", "steel"};
    EXPECT_NEAR(mesh.inner_area(where), 1., 1e-12);
    where.materials = {"glue", "glue"};
    const double in_glue = mesh.inner_area(where);
    EXPECT_NEAR(in_glue, mesh.inner_area("glue"), 1e-12);
    EXPECT_NEAR(mesh.inner_area("all") - in_glue - mesh.inner_area("steel"), 1.,
                1e-11);
  }

  TEST(NamedMesh, DegreesBeyondTwoNeedTheSplit)
  {
    const std::string degree =
        "subsection Discretization\n  set degree = 3\nend\n";
    EXPECT_TRUE(
        has(errors_of(mesh_scene(2, plate, degree)), "split simplices = true"));
    EXPECT_EQ(errors_of(mesh_scene(2, plate + "set split simplices = true\n",
                                   degree)),
              "");
  }

  std::string crystal(const std::string &grains, const std::string &size,
                      const std::string &more = "")
  {
    return "set type = voronoi\nset upper corner = 2 um, 1 um\nset grains = " +
           grains + "\nset element size = " + size + "\n" + more;
  }

  TEST(Voronoi, GrainsFillTheRectangleWithGoodQuads)
  {
    // cells of a sixth of a grain and less
    for (const char *grains : {"1", "2", "7", "50"})
      for (const char *seed : {"1", "2"}) {
        const BuiltMesh<2> mesh(mesh_scene(
            2, crystal(grains, "0.03 um", std::string("set seed = ") + seed)));
        ASSERT_TRUE(mesh.triangulation) << grains;
        EXPECT_TRUE(mesh.triangulation->all_reference_cells_are_hyper_cube());
        EXPECT_NEAR(mesh.volume("all"), 2e-12, 1e-24) << grains;
        double sum = 0.;
        for (int g = 1; g <= std::stoi(grains); ++g) {
          const double area = mesh.volume("grain " + std::to_string(g));
          EXPECT_GT(area, 0.) << "grain " << g << " of " << grains;
          sum += area;
        }
        EXPECT_NEAR(sum, 2e-12, 1e-24);
        const MeshReport report = mesh_report(*mesh.triangulation);
        // measured: 29 to 48 and 135 to 153 degrees
        EXPECT_GT(report.smallest_angle, 20.) << grains << " seed " << seed;
        EXPECT_LT(report.largest_angle, 160.) << grains << " seed " << seed;
      }
  }

  TEST(Voronoi, BoundariesOfGrainsAreAGroup)
  {
    const BuiltMesh<2> mesh(mesh_scene(2, crystal("20", "0.05 um")));
    Where between;
    between.kind = Where::Kind::between_groups;
    const double length = mesh.inner_area(between);
    EXPECT_GT(length, 0.);
    EXPECT_NEAR(mesh.inner_area("grain boundaries"), length, 1e-12 * length);
    // hexagons of the area A have half the circumference 2.632 sqrt(A) / sqrt 2
    const double hexagons =
        20 * std::sqrt(2. * std::sqrt(3.)) * std::sqrt(2e-12 / 20.);
    EXPECT_NEAR(length + 3e-6, hexagons + 1.5e-6, .25 * hexagons);
    EXPECT_EQ(errors_of(mesh_scene(2, crystal("20", "0.05 um"),
                                   interface("between grains"))),
              "");
    EXPECT_EQ(errors_of(mesh_scene(2, crystal("20", "0.05 um"),
                                   interface("grain boundaries"))),
              "");
    EXPECT_TRUE(has(errors_of(mesh_scene(2, crystal("20", "0.05 um"),
                                         interface("grain 21"))),
                    "no such group"));
  }

  TEST(Voronoi, SeedAndUnitDecide)
  {
    const BuiltMesh<2> one(mesh_scene(2, crystal("9", "0.1 um"))),
        again(mesh_scene(2, crystal("9", "0.1 um"))),
        other(mesh_scene(2, crystal("9", "0.1 um", "set seed = 7")));
    EXPECT_EQ(one.named().coordinates, again.named().coordinates);
    EXPECT_NE(one.named().coordinates, other.named().coordinates);
    // the same in numbers of any size
    const BuiltMesh<2> large(mesh_scene(
        2, "set type = voronoi\nset upper corner = 2000, 1000\nset grains = 9\n"
           "set element size = 100\n"));
    ASSERT_EQ(large.named().coordinates.size(), one.named().coordinates.size());
    for (std::size_t i = 0; i < one.named().coordinates.size(); ++i)
      EXPECT_NEAR(large.named().coordinates[i],
                  1e9 * one.named().coordinates[i], 1e-9);
  }

  TEST(Voronoi, RelaxationMakesEqualGrains)
  {
    const auto spread = [](const std::string &steps) {
      const BuiltMesh<2> mesh(
          mesh_scene(2, crystal("30", "0.03 um", "set relaxation = " + steps)));
      double sum = 0., square = 0.;
      for (int g = 1; g <= 30; ++g) {
        const double area = mesh.volume("grain " + std::to_string(g)) * 1e12;
        sum += area / 30.;
        square += area * area / 30.;
      }
      return std::sqrt(square - sum * sum) / sum;
    };
    // Poisson seeds: 0.53 in the plane
    EXPECT_GT(spread("0"), .25);
    EXPECT_LT(spread("50"), .1);
  }
} // namespace test_mesh_groups
