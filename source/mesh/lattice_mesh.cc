#include "lattice_mesh.h"

#include "mesh_topology.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    const char axis_names[] = "xyz";

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
  } // namespace

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
    return boxes<dim>(input, n);
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
             std::abs(p[1] - input.notch_height) < .5 * input.notch_width - rim;
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

  template CoarseMesh<2> lattice_mesh(const MeshInput &, unsigned int,
                                      std::vector<std::string> &);
  template CoarseMesh<3> lattice_mesh(const MeshInput &, unsigned int,
                                      std::vector<std::string> &);
  template void cut_notch(const MeshInput &, CoarseMesh<2> &,
                          std::vector<std::string> &);
  template void cut_notch(const MeshInput &, CoarseMesh<3> &,
                          std::vector<std::string> &);
  template CoarseMesh<2> cut_along_diagonal(const CoarseMesh<2> &);
  template CoarseMesh<3> cut_along_diagonal(const CoarseMesh<3> &);
} // namespace nsfd
