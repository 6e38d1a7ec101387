#include "level_mesh.h"

#include "deal_ii_message.h"
#include "mesh_topology.h"

#include <deal.II/grid/grid_tools.h>

#include <array>
#include <set>
#include <utility>
#include <vector>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /**
     * deal.II stores every line once; quads and hexes that share a line must
     * agree on its direction. True for lattices, not for any merged mesh.
     */
    template <int dim>
    bool lines_agree(const std::vector<CellData<dim>> &cells)
    {
      std::vector<std::pair<unsigned int, unsigned int>> lines;
      for (const auto &cell : cells)
        for (unsigned int v = 0; v < cell.vertices.size(); ++v)
          for (unsigned int d = 0; d < dim; ++d)
            if (!(v >> d & 1u))
              lines.emplace_back(cell.vertices[v], cell.vertices[v | 1u << d]);
      std::sort(lines.begin(), lines.end());
      return std::none_of(lines.begin(), lines.end(), [&](const auto &line) {
        return line.first < line.second &&
               std::binary_search(lines.begin(), lines.end(),
                                  std::pair(line.second, line.first));
      });
    }

    /** deal.II wants to know which of the faces with an id are inside. */
    template <int dim>
    void mark_inner_faces(CoarseMesh<dim> &mesh)
    {
      const auto mark = [&](auto &objects) {
        if (objects.empty())
          return;
        std::set<FaceKey> inner;
        for_each_face(sorted_faces(mesh),
                      [&](const CellFace &face, const std::size_t n) {
                        if (n > 1)
                          inner.insert(face.key);
                      });
        for (auto &object : objects)
          if (inner.count(face_key(object.vertices)) != 0)
            object.boundary_id = numbers::internal_face_boundary_id;
      };
      if constexpr (dim == 2)
        mark(mesh.boundary.boundary_lines);
      else
        mark(mesh.boundary.boundary_quads);
    }
  } // namespace

  std::string level_mesh_message(const std::exception &exception)
  {
    std::string result = deal_ii_message(exception);
    const std::array<std::pair<std::string, std::string>, 5> shorter = {
        {{"[Double -MAX_DOUBLE...MAX_DOUBLE (inclusive)]", "number"},
         {"[Integer]", "integer"},
         {"[Bool]", "true or false"},
         {" of length 0...4294967295 (inclusive)", ""},
         {" (inclusive)", ""}}};
    for (const auto &[from, to] : shorter)
      for (auto at = result.find(from); at != std::string::npos;
           at = result.find(from))
        result.replace(at, from.size(), to);
    return result;
  }

  template <int dim>
  CoarseMesh<dim> active_level(const Triangulation<dim> &triangulation,
                               const bool with_manifold_ids)
  {
    CoarseMesh<dim> mesh;
    std::vector<unsigned int> number(triangulation.n_vertices(),
                                     numbers::invalid_unsigned_int);
    for (const auto &cell : triangulation.active_cell_iterators()) {
      auto &data = mesh.cells.emplace_back(cell->n_vertices());
      data.material_id = cell->material_id();
      for (const unsigned int v : cell->vertex_indices()) {
        unsigned int &n = number[cell->vertex_index(v)];
        if (n == numbers::invalid_unsigned_int) {
          n = mesh.vertices.size();
          mesh.vertices.push_back(cell->vertex(v));
        }
        data.vertices[v] = n;
      }
      for (const unsigned int f : cell->face_indices()) {
        const auto face = cell->face(f);
        const bool in_group = with_manifold_ids &&
                              face->manifold_id() != numbers::flat_manifold_id;
        if (!in_group && (!face->at_boundary() || face->boundary_id() == 0))
          continue;
        CellData<dim - 1> part(face->n_vertices());
        for (const unsigned int v : face->vertex_indices())
          part.vertices[v] = number[face->vertex_index(v)];
        part.boundary_id = face->boundary_id();
        if (in_group) {
          // from the first of its two cells
          if (!face->at_boundary() && cell->neighbor(f) < cell)
            continue;
          part.manifold_id = face->manifold_id();
        }
        if constexpr (dim == 2)
          mesh.boundary.boundary_lines.push_back(part);
        else
          mesh.boundary.boundary_quads.push_back(part);
      }
    }
    return mesh;
  }

  template <int dim>
  void fill(CoarseMesh<dim> &mesh, Triangulation<dim> &triangulation)
  {
    if (mesh.cells[0].vertices.size() != dim + 1 && !lines_agree(mesh.cells))
      GridTools::consistently_order_cells(mesh.cells);
    mark_inner_faces(mesh);
    triangulation.create_triangulation(mesh.vertices, mesh.cells,
                                       mesh.boundary);
  }

  template CoarseMesh<2> active_level(const Triangulation<2> &, bool);
  template CoarseMesh<3> active_level(const Triangulation<3> &, bool);
  template void fill(CoarseMesh<2> &, Triangulation<2> &);
  template void fill(CoarseMesh<3> &, Triangulation<3> &);
} // namespace nsfd
