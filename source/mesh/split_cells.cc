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

  namespace
  {
    /** An edge, or in space a face, that is cut, and the centroids on its two
        sides. */
    template <int dim>
    struct Cut {
      std::array<unsigned int, dim> corners;
      std::array<unsigned int, 2> centres = {{no_vertex, no_vertex}};
    };
    template <int dim>
    using Cuts = std::map<unsigned int, Cut<dim>>; // by middle

    /** Of the line between the centroids with the edge. */
    Point<2> crossing(const Cut<2> &edge, const std::vector<Point<2>> &vertices)
    {
      const Point<2> &a = vertices[edge.corners[0]],
                     &b = vertices[edge.corners[1]],
                     &g = vertices[edge.centres[0]];
      const Tensor<1, 2> along = b - a, across = vertices[edge.centres[1]] - g,
                         to = g - a;
      const double t = (to[0] * across[1] - to[1] * across[0]) /
                       (along[0] * across[1] - along[1] * across[0]);
      // no third of an edge is cut off: cells would be low
      return a + std::clamp(t, 1. / 3., 2. / 3.) * along;
    }

    /** Of the line between the centroids with the face. */
    Point<3> crossing(const Cut<3> &face, const std::vector<Point<3>> &vertices)
    {
      const Point<3> &a = vertices[face.corners[0]],
                     &b = vertices[face.corners[1]],
                     &c = vertices[face.corners[2]],
                     &g = vertices[face.centres[0]];
      const Tensor<1, 3> normal = cross_product_3d(b - a, c - a),
                         across = vertices[face.centres[1]] - g;
      const Point<3> p = g + ((a - g) * normal) / (across * normal) * across;
      std::array<double, 3> shares;
      shares[0] = cross_product_3d(b - p, c - p) * normal;
      shares[1] = cross_product_3d(c - p, a - p) * normal;
      shares[2] = cross_product_3d(a - p, b - p) * normal;
      const double least = *std::min_element(shares.begin(), shares.end()) /
                           normal.norm_square();
      // not near an edge, or behind it: cells would be low
      constexpr double enough = .1, third = 1. / 3.;
      const Point<3> middle = a + third * ((b - a) + (c - a));
      const double way =
          least < enough ? (third - enough) / (third - least) : 1.;
      return middle + way * (p - middle);
    }

    /** Middles go to where these lines cross them, but for those at the
        boundary. */
    template <int dim>
    void straighten(const Cuts<dim> &cuts, std::vector<Point<dim>> &vertices)
    {
      for (const auto &[middle, cut] : cuts)
        if (cut.centres[1] != no_vertex)
          vertices[middle] = crossing(cut, vertices);
    }

    template <int dim>
    void add_cut(const unsigned int middle,
                 const std::array<unsigned int, dim> &corners,
                 const unsigned int centre, Cuts<dim> &cuts)
    {
      const auto [entry, is_new] = cuts.emplace(middle, Cut<dim>{corners});
      entry->second.centres[is_new ? 0 : 1] = centre;
    }

    /** The corners of a tetrahedron of positive volume. */
    std::vector<unsigned int> positive(std::vector<unsigned int> corners,
                                       const std::vector<Point<3>> &vertices)
    {
      const Point<3> &a = vertices[corners[0]];
      if (cross_product_3d(vertices[corners[1]] - a, vertices[corners[2]] - a) *
              (vertices[corners[3]] - a) <
          0.)
        std::swap(corners[2], corners[3]);
      return corners;
    }

    /** @p visit(end, middle of its edge) of the six parts of a triangle. */
    template <typename Visit>
    void for_sixths(const std::array<unsigned int, 3> &corners,
                    Middles<3> &middles, const Visit &visit)
    {
      for (unsigned int v = 0; v < 3; ++v) {
        const unsigned int from = corners[v], to = corners[(v + 1) % 3],
                           half = middles.of({from, to});
        for (const unsigned int end : {from, to})
          visit(end, half);
      }
    }
  } // namespace

  CoarseMesh<2> split_at_centroids(const CoarseMesh<2> &mesh,
                                   const bool is_straight)
  {
    CoarseMesh<2> result;
    result.vertices = mesh.vertices;
    Middles<2> middles(result.vertices);
    Cuts<2> edges;
    for (const auto &cell : mesh.cells) {
      const unsigned int centre = middles.of_cell(cell.vertices);
      for (unsigned int v = 0; v < 3; ++v) {
        const unsigned int a = cell.vertices[v], b = cell.vertices[(v + 1) % 3];
        const unsigned int middle = middles.of({a, b});
        if (is_straight)
          add_cut<2>(middle, {{a, b}}, centre, edges);
        CellData<2> part = cell;
        for (const auto &corners :
             {std::array{a, middle, centre}, std::array{middle, b, centre}}) {
          part.vertices.assign(corners.begin(), corners.end());
          result.cells.push_back(part);
        }
      }
    }
    straighten(edges, result.vertices);
    split_faces(mesh.boundary.boundary_lines, middles,
                result.boundary.boundary_lines);
    return result;
  }

  CoarseMesh<3> split_at_centroids(const CoarseMesh<3> &mesh,
                                   const bool is_straight)
  {
    CoarseMesh<3> result;
    result.vertices = mesh.vertices;
    Middles<3> middles(result.vertices);
    Cuts<3> faces;
    for (const auto &cell : mesh.cells) {
      const unsigned int centre = middles.of_cell(cell.vertices);
      for (const auto &local : cell_faces<3>(4)) {
        const std::array<unsigned int, 3> corners = {{cell.vertices[local[0]],
                                                      cell.vertices[local[1]],
                                                      cell.vertices[local[2]]}};
        const unsigned int middle =
            middles.of({corners[0], corners[1], corners[2]});
        if (is_straight)
          add_cut<3>(middle, corners, centre, faces);
        CellData<3> part = cell;
        for_sixths(corners, middles,
                   [&](const unsigned int end, const unsigned int half) {
                     part.vertices =
                         positive({end, half, middle, centre}, result.vertices);
                     result.cells.push_back(part);
                   });
      }
    }
    straighten(faces, result.vertices);
    for (const auto &face : mesh.boundary.boundary_quads) {
      const unsigned int middle = middles.of(face.vertices);
      CellData<2> part = face;
      for_sixths({{face.vertices[0], face.vertices[1], face.vertices[2]}},
                 middles, [&](const unsigned int end, const unsigned int half) {
                   part.vertices = {end, half, middle};
                   result.boundary.boundary_quads.push_back(part);
                 });
    }
    return result;
  }

  template CoarseMesh<2> coarse_mesh(const NamedMesh &);
  template CoarseMesh<3> coarse_mesh(const NamedMesh &);
  template CoarseMesh<2> split_at_midpoints(const CoarseMesh<2> &);
  template CoarseMesh<3> split_at_midpoints(const CoarseMesh<3> &);
} // namespace nsfd
