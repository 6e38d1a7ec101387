#pragma once

#include "nsfd/mesh/coarse_mesh.h"
#include "nsfd/scene/scene_input.h"

#include <deal.II/base/point.h>
#include <deal.II/grid/tria_description.h>

#include <array>
#include <string>
#include <vector>

namespace nsfd
{
  /** Edges, corner angles (degrees) and corner Jacobians of one cell. */
  struct CellShape {
    double shortest_edge, longest_edge;
    double smallest_angle, largest_angle;
    double scaled_jacobian; ///< smallest of the corners
  };

  /** Of a simplex (dim + 1 corners) or a quad / hex (2^dim corners). */
  template <int dim>
  CellShape cell_shape(const std::vector<dealii::Point<dim>> &corners);

  /** Local vertices of each face. */
  template <int dim>
  std::vector<std::vector<unsigned int>> cell_faces(unsigned int n_corners);

  /**
   * Move every interior vertex by less than @p share of its shortest edge; the
   * way depends on seed and position in the mesh only. What lies on a face
   * between cells of different material ids, or on one of the listed faces,
   * stays. Moves are halved at cells that would lose nine tenths of the volume
   * at a corner. Cells may be of several shapes.
   */
  template <int dim>
  void distort(CoarseMesh<dim> &mesh, double share, unsigned int seed);

  /**
   * Put the meshes into one; coinciding boundary vertices of different bodies
   * become one. The body is the material id. Overlapping boxes are problems,
   * and touching faces that do not match unless @p surfaces_meet anywhere.
   */
  template <int dim>
  CoarseMesh<dim> merge_bodies(const std::vector<BodyInput> &bodies,
                               const std::vector<CoarseMesh<dim>> &meshes,
                               bool surfaces_meet,
                               std::vector<std::string> &problems);

  /** What came from a file; cells may be of several shapes. */
  template <int dim>
  CoarseMesh<dim> coarse_mesh(const NamedMesh &named);

  /**
   * Cut every cell into one quad or hex per corner, at the midpoints of edges,
   * faces and cells. Triangles, quads, tetrahedra, hexes and prisms, in any
   * mixture; ids of cells and faces are inherited.
   */
  template <int dim>
  CoarseMesh<dim> split_at_midpoints(const CoarseMesh<dim> &mesh);

  /**
   * Cut every triangle into six, by the lines from its centroid to its corners
   * and to the midpoints of its edges; ids of cells and faces are inherited.
   * If it @p is_straight, an edge is cut where the line between the centroids
   * of its two triangles crosses it, as of Powell and Sabin: a crack may then
   * run from one to the other without a bend.
   */
  CoarseMesh<2> split_at_centroids(const CoarseMesh<2> &mesh,
                                   bool is_straight = false);

  /**
   * The same of tetrahedra: into twenty-four, by planes through centroid, an
   * edge and its opposite middle; from centroid to centroid through the face.
   */
  CoarseMesh<3> split_at_centroids(const CoarseMesh<3> &mesh,
                                   bool is_straight = false);

  /** Empty mesh, stray values, inverted and degenerate cells, doubly joined
   * faces. */
  template <int dim>
  void check(const CoarseMesh<dim> &mesh, std::vector<std::string> &problems);

  /** (1, 2) */
  template <int dim>
  std::string text(const dealii::Point<dim> &p);
} // namespace nsfd
