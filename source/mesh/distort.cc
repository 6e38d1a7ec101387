#include "cell_shapes.h"
#include "core/mix_bits.h"
#include "mesh_topology.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** Uniform in the unit ball. */
    template <int dim>
    Tensor<1, dim> random_vector(std::uint64_t state)
    {
      Tensor<1, dim> result;
      do
        for (unsigned int d = 0; d < dim; ++d) {
          state = mixed(state);
          result[d] = 2. * std::ldexp(double(state >> 11), -53) - 1.;
        }
      while (result.norm_square() > 1.);
      return result;
    }
    /** On the boundary, between cells of different ids, on faces of groups. */
    template <int dim>
    std::vector<bool> vertices_that_stay(const CoarseMesh<dim> &mesh)
    {
      std::vector<bool> stays = boundary_vertices(mesh);
      const auto mark = [&](const auto &vertices) {
        for (const unsigned int v : vertices)
          if (v != no_vertex)
            stays[v] = true;
      };
      const auto faces = sorted_faces(mesh);
      for (std::size_t i = 1; i < faces.size(); ++i)
        if (faces[i].key == faces[i - 1].key &&
            mesh.cells[faces[i].cell].material_id !=
                mesh.cells[faces[i - 1].cell].material_id)
          mark(faces[i].key);
      for (const auto &line : mesh.boundary.boundary_lines)
        mark(line.vertices);
      for (const auto &quad : mesh.boundary.boundary_quads)
        mark(quad.vertices);
      return stays;
    }

    /** At a corner the edges span less than a tenth of what they did. */
    template <int dim>
    bool is_squeezed(const CellData<dim> &cell,
                     const std::vector<Point<dim>> &before,
                     const std::vector<Point<dim>> &now)
    {
      constexpr double least = .1;
      const auto &shape = *find_cell_shape(dim, cell.vertices.size());
      const auto volume = [&](const std::vector<Point<dim>> &places,
                              const unsigned int v) {
        Tensor<2, dim> edges;
        for (unsigned int d = 0; d < dim; ++d)
          edges[d] = places[cell.vertices[shape.edges[v][d]]] -
                     places[cell.vertices[v]];
        return determinant(edges);
      };
      for (unsigned int v = 0; v < shape.n_corners; ++v)
        if (volume(now, v) < least * volume(before, v))
          return true;
      return false;
    }

    /** Moves at squeezed cells are halved, and given up in the end. */
    template <int dim>
    void move_vertices(CoarseMesh<dim> &mesh,
                       std::vector<Tensor<1, dim>> &moves)
    {
      constexpr unsigned int most_halvings = 10;
      const std::vector<Point<dim>> before = mesh.vertices;
      for (std::size_t v = 0; v < moves.size(); ++v)
        mesh.vertices[v] += moves[v];
      bool has_changed = true;
      for (unsigned int round = 0; has_changed; ++round) {
        std::vector<bool> is_at_squeezed(moves.size(), false);
        for (const auto &cell : mesh.cells)
          if (is_squeezed(cell, before, mesh.vertices))
            for (const unsigned int v : cell.vertices)
              is_at_squeezed[v] = true;
        has_changed = false;
        for (std::size_t v = 0; v < moves.size(); ++v)
          if (is_at_squeezed[v] && moves[v].norm_square() > 0.) {
            moves[v] *= round < most_halvings ? .5 : 0.;
            mesh.vertices[v] = before[v] + moves[v];
            has_changed = true;
          }
      }
    }
  } // namespace

  template <int dim>
  void distort(CoarseMesh<dim> &mesh, const double share,
               const unsigned int seed)
  {
    const std::vector<bool> stays = vertices_that_stay(mesh);
    const std::vector<double> edges = shortest_edges(mesh);
    const auto box = bounding_box(mesh.vertices);
    const double size = (box.second - box.first).norm();
    std::vector<Tensor<1, dim>> moves(mesh.vertices.size());
    for (std::size_t v = 0; v < moves.size(); ++v) {
      if (stays[v])
        continue;
      const Point<dim> &p = mesh.vertices[v];
      std::uint64_t state = mixed(seed);
      for (unsigned int d = 0; d < dim; ++d)
        state = mixed(state ^ std::uint64_t(std::llround(std::ldexp(
                                  (p[d] - box.first[d]) / size, 28))));
      moves[v] = share * edges[v] * random_vector<dim>(state);
    }
    move_vertices(mesh, moves);
  }

  template void distort(CoarseMesh<2> &, double, unsigned int);
  template void distort(CoarseMesh<3> &, double, unsigned int);
} // namespace nsfd
