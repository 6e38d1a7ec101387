#include "coarse_mesh.h"

#include "cell_shapes.h"
#include "mesh_topology.h"
#include "named_mesh.h"

#include <algorithm>
#include <map>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** Numbers for the middles of edges, faces and cells; new ones on demand.
     */
    template <int dim>
    class Middles
    {
    public:
      explicit Middles(std::vector<Point<dim>> &vertices) : vertices_(vertices)
      {
      }

      unsigned int of(const std::vector<unsigned int> &corners)
      {
        const auto [entry, is_new] = number_.emplace(
            face_key(corners), static_cast<unsigned int>(vertices_.size()));
        if (is_new)
          vertices_.push_back(mean(corners));
        return entry->second;
      }

      unsigned int of_cell(const std::vector<unsigned int> &corners)
      {
        vertices_.push_back(mean(corners));
        return unsigned(vertices_.size() - 1);
      }

    private:
      /** In the order of the numbers, so that neighbours agree to the bit. */
      Point<dim> mean(std::vector<unsigned int> corners) const
      {
        std::sort(corners.begin(), corners.end());
        Point<dim> sum;
        for (const unsigned int v : corners)
          sum += vertices_[v];
        return sum / double(corners.size());
      }

      std::vector<Point<dim>> &vertices_;
      std::map<FaceKey, unsigned int> number_;
    };

    /** The face of a cell that has these two edges at a corner. */
    std::vector<unsigned int> face_with(const CellShapeTopology &shape,
                                        const unsigned int corner,
                                        const unsigned int a,
                                        const unsigned int b)
    {
      const auto contains = [](const auto &face, const unsigned int v) {
        return std::find(face.begin(), face.end(), v) != face.end();
      };
      for (const auto &face : shape.faces)
        if (contains(face, corner) && contains(face, a) && contains(face, b))
          return face;
      return {};
    }

    template <int dim>
    void split_cell(const CellData<dim> &cell, Middles<dim> &middles,
                    std::vector<CellData<dim>> &parts)
    {
      const auto &shape = *find_cell_shape(dim, cell.vertices.size());
      const auto global = [&](const std::vector<unsigned int> &local) {
        std::vector<unsigned int> vertices;
        for (const unsigned int v : local)
          vertices.push_back(cell.vertices[v]);
        return vertices;
      };
      const unsigned int centre = middles.of_cell(cell.vertices);
      for (unsigned int v = 0; v < shape.n_corners; ++v) {
        CellData<dim> part = cell;
        part.vertices.assign(1u << dim, 0);
        const auto &ends = shape.edges[v];
        part.vertices[0] = cell.vertices[v];
        for (unsigned int d = 0; d < dim; ++d)
          part.vertices[1u << d] = middles.of(global({v, ends[d]}));
        for (unsigned int d = 0; dim == 3 && d < dim; ++d) {
          const unsigned int e = (d + 1) % dim;
          part.vertices[1u << d | 1u << e] =
              middles.of(global(face_with(shape, v, ends[d], ends[e])));
        }
        part.vertices.back() = centre;
        parts.push_back(part);
      }
    }

    void split_faces(const std::vector<CellData<1>> &lines, Middles<2> &middles,
                     std::vector<CellData<1>> &parts)
    {
      for (const auto &line : lines)
        for (const unsigned int v : line.vertices) {
          CellData<1> part = line;
          part.vertices = {v, middles.of(line.vertices)};
          parts.push_back(part);
        }
    }

    void split_faces(const std::vector<CellData<2>> &faces, Middles<3> &middles,
                     std::vector<CellData<2>> &parts)
    {
      for (const auto &face : faces) {
        const auto &shape = *find_cell_shape(2, face.vertices.size());
        const unsigned int centre = middles.of(face.vertices);
        for (unsigned int v = 0; v < shape.n_corners; ++v) {
          const auto mid = [&](const unsigned int d) {
            return middles.of(
                {face.vertices[v], face.vertices[shape.edges[v][d]]});
          };
          CellData<2> part = face;
          part.vertices = {face.vertices[v], mid(0), mid(1), centre};
          parts.push_back(part);
        }
      }
    }
  } // namespace

  template <int dim>
  CoarseMesh<dim> coarse_mesh(const NamedMesh &named)
  {
    CoarseMesh<dim> mesh;
    for (std::size_t v = 0; v < named.n_vertices(); ++v) {
      Point<dim> p;
      for (unsigned int d = 0; d < dim; ++d)
        p[d] = named.coordinates[3 * v + d];
      mesh.vertices.push_back(p);
    }
    const auto corners = [](const NamedMesh::Elements &elements,
                            const std::size_t e) {
      return std::vector<unsigned int>(
          elements.begin(e), elements.begin(e) + elements.n_vertices(e));
    };
    for (std::size_t c = 0; c < named.cells.size(); ++c) {
      CellData<dim> &cell = mesh.cells.emplace_back();
      cell.vertices = corners(named.cells, c);
      cell.material_id = named.cells.set[c];
    }
    for (std::size_t f = 0; f < named.faces.size(); ++f) {
      if (named.faces.set[f] == 0)
        continue;
      CellData<dim - 1> face;
      face.vertices = corners(named.faces, f);
      face.boundary_id = 0;
      face.manifold_id = named.faces.set[f];
      if constexpr (dim == 2)
        mesh.boundary.boundary_lines.push_back(face);
      else
        mesh.boundary.boundary_quads.push_back(face);
    }
    return mesh;
  }

  template <int dim>
  CoarseMesh<dim> split_at_midpoints(const CoarseMesh<dim> &mesh)
  {
    CoarseMesh<dim> result;
    result.vertices = mesh.vertices;
    Middles<dim> middles(result.vertices);
    for (const auto &cell : mesh.cells)
      split_cell(cell, middles, result.cells);
    if constexpr (dim == 2)
      split_faces(mesh.boundary.boundary_lines, middles,
                  result.boundary.boundary_lines);
    else
      split_faces(mesh.boundary.boundary_quads, middles,
                  result.boundary.boundary_quads);
    return result;
  }

  CoarseMesh<2> split_at_centroids(const CoarseMesh<2> &mesh)
  {
    CoarseMesh<2> result;
    result.vertices = mesh.vertices;
    Middles<2> middles(result.vertices);
    for (const auto &cell : mesh.cells) {
      const unsigned int centre = middles.of_cell(cell.vertices);
      for (unsigned int v = 0; v < 3; ++v) {
        const unsigned int a = cell.vertices[v], b = cell.vertices[(v + 1) % 3];
        const unsigned int middle = middles.of({a, b});
        CellData<2> part = cell;
        for (const auto &corners :
             {std::array{a, middle, centre}, std::array{middle, b, centre}}) {
          part.vertices.assign(corners.begin(), corners.end());
          result.cells.push_back(part);
        }
      }
    }
    split_faces(mesh.boundary.boundary_lines, middles,
                result.boundary.boundary_lines);
    return result;
  }

  template CoarseMesh<2> coarse_mesh(const NamedMesh &);
  template CoarseMesh<3> coarse_mesh(const NamedMesh &);
  template CoarseMesh<2> split_at_midpoints(const CoarseMesh<2> &);
  template CoarseMesh<3> split_at_midpoints(const CoarseMesh<3> &);
} // namespace nsfd
