#include "coarse_mesh.h"

#include <deal.II/base/exceptions.h>
#include <deal.II/grid/grid_tools.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <limits>
#include <set>
#include <unordered_map>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    constexpr unsigned int none = numbers::invalid_unsigned_int;
    constexpr std::array<unsigned int, 4> no_vertices = {
        {none, none, none, none}};
    const char axis_names[] = "xyz";

    /** Corners joined by an edge to corner @p v, in the order of the axes. */
    template <int dim>
    std::array<unsigned int, dim> neighbours(const unsigned int n_corners,
                                             const unsigned int v)
    {
      std::array<unsigned int, dim> result{};
      for (unsigned int d = 0; d < dim; ++d)
        result[d] =
            n_corners == dim + 1 ? (v + 1 + d) % (dim + 1) : v ^ (1u << d);
      return result;
    }

    double determinant(const std::array<Tensor<1, 2>, 2> &a)
    {
      return a[0][0] * a[1][1] - a[0][1] * a[1][0];
    }

    double determinant(const std::array<Tensor<1, 3>, 3> &a)
    {
      return cross_product_3d(a[0], a[1]) * a[2];
    }

    template <int dim>
    bool box_has_extent(const MeshInput &input,
                        std::vector<std::string> &problems)
    {
      const std::size_t n_problems = problems.size();
      if (input.lower.size() < dim || input.upper.size() < dim ||
          input.cells.size() < dim) {
        problems.push_back(fmt::format(
            "`lower corner`, `upper corner` and `cells` need {} entries", dim));
        return false;
      }
      double n_cells = std::ldexp(1., dim * int(input.refinements));
      for (unsigned int d = 0; d < dim; ++d) {
        // also true for NaN
        if (!(input.upper[d] > input.lower[d]) ||
            !std::isfinite(input.upper[d] - input.lower[d]))
          problems.push_back(fmt::format(
              "`upper corner` ({:g}) must lie beyond `lower corner` "
              "({:g}) in {}",
              input.upper[d], input.lower[d], axis_names[d]));
        if (input.cells[d] == 0)
          problems.push_back(
              fmt::format("`cells` must be at least 1 in {}", axis_names[d]));
        n_cells *= input.cells[d];
      }
      if (n_cells > 5e8)
        problems.push_back(
            fmt::format("{:.3g} cells are more than this build can number; "
                        "reduce `cells` or `refinements`",
                        n_cells));
      return problems.size() == n_problems;
    }

    /** Point i of n + 1, with the ends and the centre exact. */
    double graduation(const double a, const double b, const unsigned int i,
                      const unsigned int n)
    {
      return 2 * i <= n ? a + (b - a) * (double(i) / n)
                        : b - (b - a) * (double(n - i) / n);
    }

    /** Vertices and cells of a box; both run along x first. */
    template <int dim>
    CoarseMesh<dim> boxes(const MeshInput &input,
                          const std::array<unsigned int, dim> &n)
    {
      CoarseMesh<dim> mesh;
      const unsigned int nz = dim == 3 ? n[dim - 1] : 0;
      const unsigned int layer = (n[0] + 1) * (n[1] + 1);
      mesh.vertices.reserve(std::size_t(layer) * (nz + 1));
      for (unsigned int k = 0; k <= nz; ++k)
        for (unsigned int j = 0; j <= n[1]; ++j)
          for (unsigned int i = 0; i <= n[0]; ++i) {
            const unsigned int index[] = {i, j, k};
            Point<dim> p;
            for (unsigned int d = 0; d < dim; ++d)
              p[d] = graduation(input.lower[d], input.upper[d], index[d], n[d]);
            mesh.vertices.push_back(p);
          }
      CellData<dim> cell;
      mesh.cells.reserve(std::size_t(n[0]) * n[1] * std::max(nz, 1u));
      for (unsigned int k = 0; k < std::max(nz, 1u); ++k)
        for (unsigned int j = 0; j < n[1]; ++j)
          for (unsigned int i = 0; i < n[0]; ++i) {
            const unsigned int first = i + j * (n[0] + 1) + k * layer;
            for (unsigned int v = 0; v < (1u << dim); ++v)
              cell.vertices[v] = first + (v & 1) + (v >> 1 & 1) * (n[0] + 1) +
                                 (v >> 2) * layer;
            mesh.cells.push_back(cell);
          }
      return mesh;
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
    void remove_unused_vertices(CoarseMesh<dim> &mesh)
    {
      std::vector<unsigned int> index(mesh.vertices.size(), none);
      for (const auto &cell : mesh.cells)
        for (const unsigned int v : cell.vertices)
          index[v] = 0;
      unsigned int n = 0;
      for (std::size_t v = 0; v < index.size(); ++v)
        if (index[v] != none) {
          mesh.vertices[n] = mesh.vertices[v];
          index[v] = n++;
        }
      mesh.vertices.resize(n);
      const auto renumber = [&](auto &objects) {
        for (auto &object : objects)
          for (unsigned int &v : object.vertices)
            v = index[v];
      };
      renumber(mesh.cells);
      renumber(mesh.boundary.boundary_lines);
      renumber(mesh.boundary.boundary_quads);
    }

    template <int dim>
    void cut_notch(const MeshInput &input, CoarseMesh<dim> &mesh,
                   std::vector<std::string> &problems)
    {
      if (input.notch_width == 0.)
        return;
      // cells whose centre is on the rim of the slot stay, in any units
      const double rim = 1e-9 * (input.upper[1] - input.lower[1]);
      const auto in_slot = [&](const CellData<dim> &cell) {
        const Point<dim> p = centre(mesh, cell);
        return p[0] < input.lower[0] + input.notch_length - rim &&
               std::abs(p[1] - input.notch_height) <
                   .5 * input.notch_width - rim;
      };
      const auto end =
          std::remove_if(mesh.cells.begin(), mesh.cells.end(), in_slot);
      if (end == mesh.cells.end())
        problems.push_back(fmt::format(
            "the notch of width {:g} contains no cell centre; take smaller "
            "cells, "
            "or width 0 and an interface that is broken from the start",
            input.notch_width));
      mesh.cells.erase(end, mesh.cells.end());
      remove_unused_vertices(mesh);
    }

    /** The report's mesh: both diagonals of every rectangle. */
    CoarseMesh<2> cut_in_four(const CoarseMesh<2> &boxes)
    {
      CoarseMesh<2> mesh;
      mesh.vertices = boxes.vertices;
      for (const auto &box : boxes.cells) {
        const auto &v = box.vertices;
        const unsigned int c = mesh.vertices.size();
        mesh.vertices.push_back(centre(boxes, box));
        for (const auto &[a, b] :
             {std::pair{v[0], v[1]}, {v[1], v[3]}, {v[3], v[2]}, {v[2], v[0]}})
          mesh.cells.emplace_back(3).vertices = {a, b, c};
      }
      return mesh;
    }

    /**
     * Kuhn's simplices, all on the diagonal from the lower to the upper
     * corner: one per order in which the axes are walked.
     */
    template <int dim>
    CoarseMesh<dim> cut_along_diagonal(const CoarseMesh<dim> &boxes)
    {
      CoarseMesh<dim> mesh;
      mesh.vertices = boxes.vertices;
      for (const auto &box : boxes.cells) {
        std::array<unsigned int, dim> order{};
        for (unsigned int d = 0; d < dim; ++d)
          order[d] = d;
        do {
          std::vector<unsigned int> v = {box.vertices[0]};
          unsigned int corner = 0;
          for (const unsigned int d : order)
            v.push_back(box.vertices[corner |= 1u << d]);
          unsigned int inversions = 0;
          for (unsigned int a = 0; a < dim; ++a)
            for (unsigned int b = a + 1; b < dim; ++b)
              inversions += order[a] > order[b];
          if (inversions % 2 == 1)
            std::swap(v[dim - 1], v[dim]);
          mesh.cells.emplace_back(dim + 1).vertices = v;
        } while (std::next_permutation(order.begin(), order.end()));
      }
      return mesh;
    }

    struct Face {
      std::array<unsigned int, 4> key; ///< sorted vertices, filled with `none`
      unsigned int cell, number;
    };

    /** All faces of all cells, equal faces next to each other. */
    template <int dim>
    std::vector<Face> sorted_faces(const CoarseMesh<dim> &mesh)
    {
      std::vector<Face> faces;
      std::vector<std::vector<unsigned int>> local;
      unsigned int n_corners = 0;
      for (unsigned int c = 0; c < mesh.cells.size(); ++c) {
        const auto &v = mesh.cells[c].vertices;
        if (v.size() != n_corners) {
          n_corners = v.size();
          local = cell_faces<dim>(n_corners);
          faces.reserve(mesh.cells.size() * local.size());
        }
        for (unsigned int f = 0; f < local.size(); ++f) {
          Face face{no_vertices, c, f};
          for (unsigned int i = 0; i < local[f].size(); ++i)
            face.key[i] = v[local[f][i]];
          std::sort(face.key.begin(), face.key.end());
          faces.push_back(face);
        }
      }
      std::sort(faces.begin(), faces.end(), [](const Face &a, const Face &b) {
        return a.key < b.key || (a.key == b.key && a.cell < b.cell);
      });
      return faces;
    }

    /** Call @p action(first, number of cells) for every different face. */
    template <typename Action>
    void for_each_face(const std::vector<Face> &faces, const Action &action)
    {
      for (std::size_t i = 0, n = 0; i < faces.size(); i += n) {
        for (n = 1; i + n < faces.size() && faces[i + n].key == faces[i].key;)
          ++n;
        action(faces[i], n);
      }
    }

    template <int dim>
    std::vector<bool> boundary_vertices(const CoarseMesh<dim> &mesh)
    {
      std::vector<bool> result(mesh.vertices.size(), false);
      for_each_face(sorted_faces(mesh), [&](const Face &face, std::size_t n) {
        if (n == 1)
          for (const unsigned int v : face.key)
            if (v != none)
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
          for (const unsigned int j :
               neighbours<dim>(cell.vertices.size(), i)) {
            const unsigned int v = cell.vertices[i];
            result[v] = std::min(
                result[v],
                mesh.vertices[v].distance(mesh.vertices[cell.vertices[j]]));
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

    /** splitmix64 */
    std::uint64_t mixed(std::uint64_t z)
    {
      z += 0x9e3779b97f4a7c15u;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
      return z ^ (z >> 31);
    }

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

    /** A plane convex face: is @p p on it, up to @p tolerance? */
    template <int dim>
    bool lies_on(const Point<dim> &p, const std::vector<Point<dim>> &face,
                 const double tolerance)
    {
      if constexpr (dim == 2) {
        const Tensor<1, 2> edge = face[1] - face[0], q = p - face[0];
        const double along = q * edge / edge.norm();
        return along > -tolerance && along < edge.norm() + tolerance &&
               std::abs(q[0] * edge[1] - q[1] * edge[0]) <
                   tolerance * edge.norm();
      } else {
        // triangles (0, 1, 2) and, of a quad in lexicographic order, (3, 2, 1)
        for (unsigned int part = 0; part + 2 < face.size(); ++part) {
          const Point<dim> &o = face[part == 0 ? 0 : 3];
          const Tensor<1, dim> a = face[part == 0 ? 1 : 2] - o,
                               b = face[part == 0 ? 2 : 1] - o, q = p - o;
          const Tensor<1, dim> normal = cross_product_3d(a, b);
          const double area_2 = normal.norm_square();
          const double s = cross_product_3d(q, b) * normal / area_2,
                       t = cross_product_3d(a, q) * normal / area_2;
          if (std::abs(q * normal) < tolerance * std::sqrt(area_2) &&
              s > -1e-9 && t > -1e-9 && s + t < 1. + 1e-9)
            return true;
        }
        return false;
      }
    }

    /** Vertices of different bodies at one place get one number. */
    template <int dim>
    void glue(CoarseMesh<dim> &mesh, const double tolerance)
    {
      const std::vector<bool> at_boundary = boundary_vertices(mesh);
      std::vector<unsigned int> body(mesh.vertices.size(), none);
      for (const auto &cell : mesh.cells)
        for (const unsigned int v : cell.vertices)
          body[v] = cell.material_id;

      using Bin = std::array<std::int64_t, 3>;
      const auto hash = [](const Bin &bin) {
        return mixed(bin[0] + mixed(bin[1] + mixed(bin[2])));
      };
      const Point<dim> lower = bounding_box(mesh.vertices).first;
      std::unordered_map<Bin, std::vector<unsigned int>, decltype(hash)> bins(
          16, hash);
      std::vector<unsigned int> number(mesh.vertices.size());
      for (unsigned int v = 0; v < mesh.vertices.size(); ++v) {
        number[v] = v;
        if (!at_boundary[v])
          continue;
        Bin bin{};
        for (unsigned int d = 0; d < dim; ++d)
          bin[d] =
              std::llround((mesh.vertices[v][d] - lower[d]) / (2. * tolerance));
        for (unsigned int n = 0; n < (dim == 2 ? 9 : 27); ++n) {
          const Bin near = {{bin[0] + n % 3 - 1, bin[1] + n / 3 % 3 - 1,
                             dim == 2 ? 0 : bin[2] + n / 9 - 1}};
          const auto found = bins.find(near);
          if (found != bins.end())
            for (const unsigned int w : found->second)
              if (body[w] != body[v] &&
                  mesh.vertices[v].distance(mesh.vertices[w]) <= tolerance)
                number[v] = std::min(number[v], number[w]);
        }
        bins[bin].push_back(v);
      }
      const auto renumber = [&](auto &objects) {
        for (auto &object : objects)
          for (unsigned int &v : object.vertices)
            v = number[v];
      };
      renumber(mesh.cells);
      renumber(mesh.boundary.boundary_lines);
      renumber(mesh.boundary.boundary_quads);
      remove_unused_vertices(mesh);
    }

    /** Boundary ids stay only where the face still is at the boundary. */
    template <int dim>
    void drop_inner_boundary_ids(CoarseMesh<dim> &mesh)
    {
      std::set<std::array<unsigned int, 4>> inner;
      for_each_face(sorted_faces(mesh), [&](const Face &face, std::size_t n) {
        if (n > 1)
          inner.insert(face.key);
      });
      const auto drop = [&](auto &objects) {
        objects.erase(std::remove_if(objects.begin(), objects.end(),
                                     [&](const auto &object) {
                                       auto key = no_vertices;
                                       std::copy(object.vertices.begin(),
                                                 object.vertices.end(),
                                                 key.begin());
                                       std::sort(key.begin(), key.end());
                                       return inner.count(key) != 0;
                                     }),
                      objects.end());
      };
      if (dim == 2)
        drop(mesh.boundary.boundary_lines);
      else
        drop(mesh.boundary.boundary_quads);
    }

    /** Faces of two bodies that lie on each other without being one face. */
    template <int dim>
    void find_unmatched_faces(const CoarseMesh<dim> &mesh,
                              const std::vector<BodyInput> &bodies,
                              const double tolerance,
                              std::vector<std::string> &problems)
    {
      struct Item {
        std::vector<Point<dim>> corners, probes;
        std::pair<Point<dim>, Point<dim>> box;
      };
      std::vector<std::vector<Item>> items(bodies.size());
      for_each_face(sorted_faces(mesh), [&](const Face &face, std::size_t n) {
        if (n > 1)
          return;
        const auto &cell = mesh.cells[face.cell];
        Item item;
        Point<dim> middle;
        const auto faces = cell_faces<dim>(cell.vertices.size());
        for (const unsigned int i : faces[face.number])
          item.corners.push_back(mesh.vertices[cell.vertices[i]]);
        for (const auto &p : item.corners)
          middle += p / double(item.corners.size());
        for (const auto &p : item.corners)
          item.probes.push_back(p + 1e-3 * (middle - p));
        item.probes.push_back(middle);
        item.box = bounding_box(item.corners);
        items[cell.material_id].push_back(item);
      });
      const auto apart = [&](const auto &a, const auto &b) {
        for (unsigned int d = 0; d < dim; ++d)
          if (a.first[d] > b.second[d] + tolerance ||
              b.first[d] > a.second[d] + tolerance)
            return true;
        return false;
      };
      std::vector<std::pair<Point<dim>, Point<dim>>> boxes;
      for (auto &list : items) {
        std::vector<Point<dim>> corners;
        for (const auto &item : list)
          corners.insert(corners.end(), item.corners.begin(),
                         item.corners.end());
        boxes.push_back(bounding_box(corners));
        std::sort(list.begin(), list.end(), [](const Item &a, const Item &b) {
          return a.box.first[0] < b.box.first[0];
        });
      }
      const auto overlap = [&](const Item &a, const Item &b) {
        const auto any_on = [&](const Item &probing, const Item &face) {
          return std::any_of(probing.probes.begin(), probing.probes.end(),
                             [&](const auto &p) {
                               return lies_on(p, face.corners, tolerance);
                             });
        };
        return any_on(a, b) || any_on(b, a);
      };
      for (unsigned int a = 0; a < bodies.size(); ++a)
        for (unsigned int b = a + 1; b < bodies.size(); ++b) {
          if (items[a].empty() || items[b].empty() || apart(boxes[a], boxes[b]))
            continue;
          std::vector<const Item *> near;
          double width = 0.;
          for (const auto &item : items[b])
            if (!apart(item.box, boxes[a])) {
              near.push_back(&item);
              width = std::max(width, item.box.second[0] - item.box.first[0]);
            }
          const Item *found = nullptr;
          for (const auto &item : items[a]) {
            auto other = std::lower_bound(near.begin(), near.end(),
                                          item.box.first[0] - width - tolerance,
                                          [](const Item *i, const double x) {
                                            return i->box.first[0] < x;
                                          });
            for (; found == nullptr && other != near.end() &&
                   (*other)->box.first[0] <= item.box.second[0] + tolerance;
                 ++other)
              if (!apart(item.box, (*other)->box) && overlap(item, **other))
                found = &item;
          }
          if (found != nullptr)
            problems.push_back(fmt::format(
                "bodies `{}` and `{}` touch at {}, but their faces do not "
                "match "
                "there, so nothing would act between them; give both the same "
                "cells along the contact or leave a gap",
                bodies[a].name, bodies[b].name, text(found->probes.back())));
        }
    }

    template <int dim>
    void find_overlapping_boxes(const std::vector<BodyInput> &bodies,
                                const std::vector<CoarseMesh<dim>> &meshes,
                                const double tolerance,
                                std::vector<std::string> &problems)
    {
      for (unsigned int a = 0; a < bodies.size(); ++a)
        for (unsigned int b = a + 1; b < bodies.size(); ++b) {
          if (!is_box(bodies[a].mesh.type) || !is_box(bodies[b].mesh.type))
            continue;
          const auto box_a = bounding_box(meshes[a].vertices),
                     box_b = bounding_box(meshes[b].vertices);
          bool overlap = true;
          for (unsigned int d = 0; d < dim; ++d)
            overlap &= std::min(box_a.second[d], box_b.second[d]) >
                       std::max(box_a.first[d], box_b.first[d]) + tolerance;
          if (overlap)
            problems.push_back(fmt::format("bodies `{}` and `{}` overlap",
                                           bodies[a].name, bodies[b].name));
        }
    }
  } // namespace

  template <int dim>
  std::string text(const Point<dim> &p)
  {
    std::string result = "(";
    for (unsigned int d = 0; d < dim; ++d)
      result += fmt::format("{}{:g}", d == 0 ? "" : ", ", p[d]);
    return result + ")";
  }

  template <int dim>
  CellShape cell_shape(const std::vector<Point<dim>> &corners)
  {
    const unsigned int n = corners.size();
    const bool simplex = n == dim + 1;
    CellShape shape{std::numeric_limits<double>::max(), 0., 180., 0.,
                    std::numeric_limits<double>::max()};
    // the equilateral simplex has 1
    const double factor =
        simplex ? (dim == 2 ? 2. / std::sqrt(3.) : std::sqrt(2.)) : 1.;
    for (unsigned int v = 0; v < n; ++v) {
      const auto ends = neighbours<dim>(n, v);
      std::array<Tensor<1, dim>, dim> edges, columns;
      double lengths = 1.;
      for (unsigned int d = 0; d < dim; ++d) {
        edges[d] = corners[ends[d]] - corners[v];
        columns[d] = simplex       ? Tensor<1, dim>(corners[d + 1] - corners[0])
                     : v >> d & 1u ? -edges[d]
                                   : edges[d];
        const double length = edges[d].norm();
        lengths *= length;
        shape.shortest_edge = std::min(shape.shortest_edge, length);
        shape.longest_edge = std::max(shape.longest_edge, length);
      }
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < a; ++b) {
          const double angle =
              std::acos(std::clamp(edges[a] * edges[b] /
                                       (edges[a].norm() * edges[b].norm()),
                                   -1., 1.)) *
              180. / numbers::PI;
          shape.smallest_angle = std::min(shape.smallest_angle, angle);
          shape.largest_angle = std::max(shape.largest_angle, angle);
        }
      const double scaled =
          lengths > 0. ? factor * determinant(columns) / lengths : 0.;
      shape.scaled_jacobian = std::min(shape.scaled_jacobian, scaled);
    }
    return shape;
  }

  template <int dim>
  std::vector<std::vector<unsigned int>>
  cell_faces(const unsigned int n_corners)
  {
    std::vector<std::vector<unsigned int>> faces;
    if (n_corners == dim + 1)
      for (unsigned int left_out = 0; left_out <= dim; ++left_out) {
        faces.emplace_back();
        for (unsigned int v = 0; v <= dim; ++v)
          if (v != left_out)
            faces.back().push_back(v);
      }
    else
      for (unsigned int f = 0; f < 2 * dim; ++f) {
        faces.emplace_back();
        for (unsigned int v = 0; v < n_corners; ++v)
          if ((v >> (f / 2) & 1u) == f % 2)
            faces.back().push_back(v);
      }
    return faces;
  }

  bool is_box(const std::string &type)
  {
    return type == "rectangle" || type == "brick" ||
           type == "crossed triangles" || type == "diagonal triangles" ||
           type == "tetrahedra";
  }

  template <int dim>
  CoarseMesh<dim> lattice_mesh(const MeshInput &input,
                               const unsigned int refinements,
                               std::vector<std::string> &problems)
  {
    MeshInput refined = input;
    refined.refinements = refinements;
    if (!box_has_extent<dim>(refined, problems))
      return {};
    std::array<unsigned int, dim> n{};
    for (unsigned int d = 0; d < dim; ++d)
      n[d] = input.cells[d] << refinements;

    CoarseMesh<dim> mesh = boxes<dim>(input, n);
    if (input.type == "notched plate")
      cut_notch(input, mesh, problems);
    if constexpr (dim == 2)
      if (input.type == "crossed triangles")
        mesh = cut_in_four(mesh);
    if (input.type == "diagonal triangles" || input.type == "tetrahedra")
      mesh = cut_along_diagonal(mesh);
    return mesh;
  }

  template <int dim>
  void distort(CoarseMesh<dim> &mesh, const double share,
               const unsigned int seed)
  {
    const std::vector<bool> at_boundary = boundary_vertices(mesh);
    const std::vector<double> edges = shortest_edges(mesh);
    const auto box = bounding_box(mesh.vertices);
    const double size = (box.second - box.first).norm();
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      if (at_boundary[v])
        continue;
      Point<dim> &p = mesh.vertices[v];
      std::uint64_t state = mixed(seed);
      for (unsigned int d = 0; d < dim; ++d)
        state = mixed(state ^ std::uint64_t(std::llround(std::ldexp(
                                  (p[d] - box.first[d]) / size, 28))));
      p += share * edges[v] * random_vector<dim>(state);
    }
  }

  template <int dim>
  CoarseMesh<dim> merge_bodies(const std::vector<BodyInput> &bodies,
                               const std::vector<CoarseMesh<dim>> &meshes,
                               std::vector<std::string> &problems)
  {
    CoarseMesh<dim> all;
    double shortest = std::numeric_limits<double>::max();
    for (unsigned int b = 0; b < meshes.size(); ++b) {
      const unsigned int first = all.vertices.size();
      const auto append = [&](auto objects, auto &list) {
        for (auto &object : objects) {
          for (unsigned int &v : object.vertices)
            v += first;
          list.push_back(object);
        }
      };
      const std::size_t first_cell = all.cells.size();
      append(meshes[b].cells, all.cells);
      for (std::size_t c = first_cell; c < all.cells.size(); ++c)
        all.cells[c].material_id = b;
      append(meshes[b].boundary.boundary_lines, all.boundary.boundary_lines);
      append(meshes[b].boundary.boundary_quads, all.boundary.boundary_quads);
      all.vertices.insert(all.vertices.end(), meshes[b].vertices.begin(),
                          meshes[b].vertices.end());
      if (!meshes[b].cells.empty() && !all.cells.empty() &&
          meshes[b].cells[0].vertices.size() != all.cells[0].vertices.size()) {
        problems.push_back(fmt::format(
            "bodies `{}` and `{}` have cells of different kinds; use either "
            "quads and hexes or triangles and tetrahedra for all bodies",
            bodies[0].name, bodies[b].name));
        return {};
      }
      for (const double edge : shortest_edges(meshes[b]))
        shortest = std::min(shortest, edge);
    }
    if (all.cells.empty())
      return all;
    // no closer than the rounding of the coordinates allows
    const auto box = bounding_box(all.vertices);
    double extent = 0.;
    for (unsigned int d = 0; d < dim; ++d)
      extent =
          std::max({extent, std::abs(box.first[d]), std::abs(box.second[d])});
    const double tolerance = std::max(1e-10 * shortest, 4e-16 * extent);

    find_overlapping_boxes(bodies, meshes, tolerance, problems);
    if (!problems.empty())
      return all;
    glue(all, tolerance);
    drop_inner_boundary_ids(all);
    for_each_face(sorted_faces(all), [&](const Face &face, std::size_t n) {
      if (n > 2 && problems.empty())
        problems.push_back(fmt::format(
            "{} cells meet at one face of body `{}` near {}; bodies overlap", n,
            bodies[all.cells[face.cell].material_id].name,
            text(centre(all, all.cells[face.cell]))));
    });
    find_unmatched_faces(all, bodies, tolerance, problems);
    return all;
  }

  template <int dim>
  void check(const CoarseMesh<dim> &mesh, std::vector<std::string> &problems)
  {
    if (mesh.cells.empty()) {
      problems.push_back("the mesh has no cell");
      return;
    }
    for (const auto &p : mesh.vertices)
      for (unsigned int d = 0; d < dim; ++d)
        if (!std::isfinite(p[d])) {
          problems.push_back("a vertex is at " + text(p));
          return;
        }
    unsigned int n_bad = 0;
    std::vector<Point<dim>> corners;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
      const auto &cell = mesh.cells[c];
      corners.clear();
      for (const unsigned int v : cell.vertices)
        corners.push_back(mesh.vertices[v]);
      const double jacobian = cell_shape(corners).scaled_jacobian;
      // slivers of any thinness are cells; what rounding leaves is not
      const bool bad =
          !(jacobian > 1e-14) ||
          !(GridTools::cell_measure(mesh.vertices,
                                    make_array_view(cell.vertices)) > 0.);
      if (!bad)
        continue;
      if (++n_bad <= 3)
        problems.push_back(fmt::format(
            "cell {} at {} is {} (smallest scaled corner Jacobian "
            "{:.3g})",
            c, text(centre(mesh, cell)),
            std::abs(jacobian) > 1e-14 ? "inverted" : "degenerate", jacobian));
    }
    if (n_bad > 3)
      problems.push_back(
          fmt::format("and {} more of {} cells are inverted or degenerate",
                      n_bad - 3, mesh.cells.size()));
  }

  template std::string text(const Point<2> &);
  template std::string text(const Point<3> &);
  template CellShape cell_shape(const std::vector<Point<2>> &);
  template CellShape cell_shape(const std::vector<Point<3>> &);
  template std::vector<std::vector<unsigned int>> cell_faces<2>(unsigned int);
  template std::vector<std::vector<unsigned int>> cell_faces<3>(unsigned int);
  template CoarseMesh<2> lattice_mesh(const MeshInput &, unsigned int,
                                      std::vector<std::string> &);
  template CoarseMesh<3> lattice_mesh(const MeshInput &, unsigned int,
                                      std::vector<std::string> &);
  template void distort(CoarseMesh<2> &, double, unsigned int);
  template void distort(CoarseMesh<3> &, double, unsigned int);
  template CoarseMesh<2> merge_bodies(const std::vector<BodyInput> &,
                                      const std::vector<CoarseMesh<2>> &,
                                      std::vector<std::string> &);
  template CoarseMesh<3> merge_bodies(const std::vector<BodyInput> &,
                                      const std::vector<CoarseMesh<3>> &,
                                      std::vector<std::string> &);
  template void check(const CoarseMesh<2> &, std::vector<std::string> &);
  template void check(const CoarseMesh<3> &, std::vector<std::string> &);
} // namespace nsfd
