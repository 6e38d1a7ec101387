#pragma once

#include "coarse_mesh.h"

#include <array>
#include <utility>
#include <vector>

namespace nsfd
{
  constexpr unsigned int no_vertex = dealii::numbers::invalid_unsigned_int;

  /** Sorted vertices of a face, filled with `no_vertex`. */
  using FaceKey = std::array<unsigned int, 4>;
  FaceKey face_key(const std::vector<unsigned int> &vertices);

  struct CellFace {
    FaceKey key;
    unsigned int cell, number;
  };

  /** All faces of all cells, equal faces next to each other. */
  template <int dim>
  std::vector<CellFace> sorted_faces(const CoarseMesh<dim> &mesh);

  /** Call @p action(first, number of cells) for every different face. */
  template <typename Action>
  void for_each_face(const std::vector<CellFace> &faces, const Action &action)
  {
    for (std::size_t i = 0, n = 0; i < faces.size(); i += n) {
      for (n = 1; i + n < faces.size() && faces[i + n].key == faces[i].key;)
        ++n;
      action(faces[i], n);
    }
  }

  /** Corners joined by an edge to corner @p v, in the order of the axes. */
  template <int dim>
  std::array<unsigned int, dim> neighbours(unsigned int n_corners,
                                           unsigned int v);

  template <int dim>
  std::vector<bool> boundary_vertices(const CoarseMesh<dim> &mesh);

  /** Per vertex. */
  template <int dim>
  std::vector<double> shortest_edges(const CoarseMesh<dim> &mesh);

  template <int dim>
  std::pair<dealii::Point<dim>, dealii::Point<dim>>
  bounding_box(const std::vector<dealii::Point<dim>> &points);

  /** Mean of the corners. */
  template <int dim>
  dealii::Point<dim> centre(const CoarseMesh<dim> &mesh,
                            const dealii::CellData<dim> &cell);

  /** Vertex v becomes number[v] in cells and boundary faces. */
  template <int dim>
  void renumber(CoarseMesh<dim> &mesh, const std::vector<unsigned int> &number);

  template <int dim>
  void remove_unused_vertices(CoarseMesh<dim> &mesh);
} // namespace nsfd
