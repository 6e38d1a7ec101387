#include "mesh_checks.h"

namespace mesh_checks::test_mesh_sides
{
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
} // namespace mesh_checks::test_mesh_sides
