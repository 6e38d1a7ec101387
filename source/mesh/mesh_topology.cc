#include "mesh_topology.h"

#include "cell_shapes.h"

#include <algorithm>
#include <limits>

namespace nsfd
{
  using namespace dealii;

  FaceKey face_key(const std::vector<unsigned int> &vertices)
  {
    FaceKey key = {{no_vertex, no_vertex, no_vertex, no_vertex}};
    std::copy(vertices.begin(), vertices.end(), key.begin());
    std::sort(key.begin(), key.end());
    return key;
  }

  template <int dim>
  std::vector<CellFace> sorted_faces(const CoarseMesh<dim> &mesh)
  {
    std::vector<CellFace> faces;
    std::vector<std::vector<unsigned int>> local;
    std::vector<unsigned int> vertices;
    unsigned int n_corners = 0;
    for (unsigned int c = 0; c < mesh.cells.size(); ++c) {
      const auto &v = mesh.cells[c].vertices;
      if (v.size() != n_corners) {
        n_corners = v.size();
        local = cell_faces<dim>(n_corners);
        faces.reserve(mesh.cells.size() * local.size());
      }
      for (unsigned int f = 0; f < local.size(); ++f) {
        vertices.clear();
        for (const unsigned int i : local[f])
          vertices.push_back(v[i]);
        faces.push_back({face_key(vertices), c, f});
      }
    }
    std::sort(faces.begin(), faces.end(),
              [](const CellFace &a, const CellFace &b) {
                return a.key < b.key || (a.key == b.key && a.cell < b.cell);
              });
    return faces;
  }

  template <int dim>
  std::array<unsigned int, dim> neighbours(const unsigned int n_corners,
                                           const unsigned int v)
  {
    std::array<unsigned int, dim> result{};
    if (n_corners != dim + 1 && n_corners != 1u << dim) {
      const auto &edges = find_cell_shape(dim, n_corners)->edges[v];
      std::copy(edges.begin(), edges.end(), result.begin());
      return result;
    }
    for (unsigned int d = 0; d < dim; ++d)
      result[d] =
          n_corners == dim + 1 ? (v + 1 + d) % (dim + 1) : v ^ (1u << d);
    return result;
  }

  template <int dim>
  std::vector<bool> boundary_vertices(const CoarseMesh<dim> &mesh)
  {
    std::vector<bool> result(mesh.vertices.size(), false);
    for_each_face(sorted_faces(mesh), [&](const CellFace &face, std::size_t n) {
      if (n == 1)
        for (const unsigned int v : face.key)
          if (v != no_vertex)
            result[v] = true;
    });
    return result;
  }

  template <int dim>
  std::vector<double> shortest_edges(const CoarseMesh<dim> &mesh)
  {
    std::vector<double> result(mesh.vertices.size(),
                               std::numeric_limits<double>::max());
    for (const auto &cell : mesh.cells)
      for (unsigned int i = 0; i < cell.vertices.size(); ++i)
        for (const unsigned int j : neighbours<dim>(cell.vertices.size(), i)) {
          const unsigned int v = cell.vertices[i];
          result[v] = std::min(result[v], mesh.vertices[v].distance(
                                              mesh.vertices[cell.vertices[j]]));
        }
    return result;
  }

  template <int dim>
  std::pair<Point<dim>, Point<dim>>
  bounding_box(const std::vector<Point<dim>> &points)
  {
    std::pair<Point<dim>, Point<dim>> box;
    if (!points.empty())
      box = {points[0], points[0]};
    for (const auto &p : points)
      for (unsigned int d = 0; d < dim; ++d) {
        box.first[d] = std::min(box.first[d], p[d]);
        box.second[d] = std::max(box.second[d], p[d]);
      }
    return box;
  }

  template <int dim>
  Point<dim> centre(const CoarseMesh<dim> &mesh, const CellData<dim> &cell)
  {
    Point<dim> sum;
    for (const unsigned int v : cell.vertices)
      sum += mesh.vertices[v];
    return sum / double(cell.vertices.size());
  }

  template <int dim>
  void renumber(CoarseMesh<dim> &mesh, const std::vector<unsigned int> &number)
  {
    const auto apply = [&](auto &objects) {
      for (auto &object : objects)
        for (unsigned int &v : object.vertices)
          v = number[v];
    };
    apply(mesh.cells);
    apply(mesh.boundary.boundary_lines);
    apply(mesh.boundary.boundary_quads);
  }

  template <int dim>
  void remove_unused_vertices(CoarseMesh<dim> &mesh)
  {
    std::vector<unsigned int> number(mesh.vertices.size(), no_vertex);
    for (const auto &cell : mesh.cells)
      for (const unsigned int v : cell.vertices)
        number[v] = 0;
    unsigned int n = 0;
    for (std::size_t v = 0; v < number.size(); ++v)
      if (number[v] != no_vertex) {
        mesh.vertices[n] = mesh.vertices[v];
        number[v] = n++;
      }
    mesh.vertices.resize(n);
    renumber(mesh, number);
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template std::vector<CellFace> sorted_faces(const CoarseMesh<dim> &);        \
  template std::array<unsigned int, dim> neighbours<dim>(unsigned int,         \
                                                         unsigned int);        \
  template std::vector<bool> boundary_vertices(const CoarseMesh<dim> &);       \
  template std::vector<double> shortest_edges(const CoarseMesh<dim> &);        \
  template std::pair<Point<dim>, Point<dim>> bounding_box(                     \
      const std::vector<Point<dim>> &);                                        \
  template Point<dim> centre(const CoarseMesh<dim> &, const CellData<dim> &);  \
  template void renumber(CoarseMesh<dim> &,                                    \
                         const std::vector<unsigned int> &);                   \
  template void remove_unused_vertices(CoarseMesh<dim> &)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
#undef NSFD_INSTANTIATE
} // namespace nsfd
