#include "coarse_mesh.h"

#include "cell_shapes.h"
#include "mesh_topology.h"

#include <deal.II/grid/grid_tools.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    double determinant(const std::array<Tensor<1, 2>, 2> &a)
    {
      return a[0][0] * a[1][1] - a[0][1] * a[1][0];
    }

    double determinant(const std::array<Tensor<1, 3>, 3> &a)
    {
      return cross_product_3d(a[0], a[1]) * a[2];
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
    if (n_corners != dim + 1 && n_corners != 1u << dim)
      return find_cell_shape(dim, n_corners)->faces;
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

  template <int dim>
  void check(const CoarseMesh<dim> &mesh, std::vector<std::string> &problems)
  {
    if (mesh.cells.empty()) {
      problems.push_back("the mesh has no cell");
      return;
    }
    for (const auto &cell : mesh.cells)
      if (cell.vertices.size() != mesh.cells[0].vertices.size()) {
        problems.push_back("the mesh has cells of different shapes; write "
                           "`split simplices = true`");
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
  template void check(const CoarseMesh<2> &, std::vector<std::string> &);
  template void check(const CoarseMesh<3> &, std::vector<std::string> &);
} // namespace nsfd
