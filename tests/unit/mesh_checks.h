#pragma once

#include "mesh/mesh_builder.h"
#include "nsfd/mesh/mesh_type.h"

#include <deal.II/base/mpi.h>
#include <deal.II/distributed/shared_tria.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/grid/grid_tools.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numeric>

// Every test is right on any number of ranks.

namespace mesh_checks
{
  using namespace nsfd;
  using namespace dealii;

  inline MeshInput box(const std::string &type,
                       const std::vector<double> &lower,
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
  inline MeshInput cells_of_side_one(const std::string &type,
                                     const unsigned int dim,
                                     const unsigned int p)
  {
    return box(type, std::vector<double>(dim, 0.),
               std::vector<double>(dim, double(p)),
               std::vector<unsigned int>(dim, p));
  }

  inline MeshInput generator(const std::string &name,
                             const std::string &arguments)
  {
    MeshInput mesh;
    mesh.type = name;
    mesh.generator_arguments = arguments;
    return mesh;
  }

  inline SceneInput scene_of(const MeshInput &mesh)
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

  /** Of the faces of own and ghost cells: boundary or not, and ids. */
  template <int dim>
  std::map<CellId, std::vector<std::array<unsigned int, 4>>>
  faces(const Triangulation<dim> &triangulation)
  {
    std::map<CellId, std::vector<std::array<unsigned int, 4>>> result;
    for (const auto &cell : triangulation.active_cell_iterators())
      if (!cell->is_artificial())
        for (const unsigned int f : cell->face_indices()) {
          const auto face = cell->face(f);
          result[cell->id()].push_back(
              {{cell->material_id(), face->at_boundary(), face->boundary_id(),
                face->manifold_id()}});
        }
    return result;
  }

  /** Cells of @p some that are not the same in @p all. */
  template <typename Values>
  unsigned int n_different(const std::map<CellId, Values> &some,
                           const std::map<CellId, Values> &all)
  {
    unsigned int n = 0;
    for (const auto &[id, values] : some)
      n += all.count(id) == 0 || all.at(id) != values;
    return n;
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
    EXPECT_EQ(n_different(vertices(*mesh), reference), 0u);
    EXPECT_EQ(n_different(faces(*mesh), faces(*whole)), 0u);
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

  inline bool contains(const std::string &text, const std::string &part)
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

  inline Where side(const std::string &name)
  {
    return {Where::Kind::side, name, {}, {}};
  }

  inline Where group(const std::string &name)
  {
    return {Where::Kind::group, name, {}, {}};
  }

  inline Where between(const std::string &a, const std::string &b)
  {
    return {Where::Kind::between_materials, "", {{a, b}}, {}};
  }

  inline MaterialInput material(const std::string &name, const Where &where)
  {
    MaterialInput result;
    result.name = name;
    result.where = where;
    return result;
  }
} // namespace mesh_checks
