#pragma once

#include "mesh/coarse_mesh.h"

#include <array>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace nsfd
{
  /**
   * Triangles that are halved and stay conforming: bisection of the newest
   * vertex (Mitchell 1989). The first edge of a triangle to be cut is its
   * longest one; a half is cut next opposite to the new vertex. All
   * descendants of a triangle have four shapes, and none of their angles is
   * less than half of its smallest one. Cells that share the edge are halved
   * with it, after the cut of an edge of their own where they need one.
   */
  class Bisection
  {
  public:
    static constexpr unsigned int none = unsigned(-1);

    /** Of triangles alone. */
    explicit Bisection(CoarseMesh<2> mesh);

    struct Cell {
      /// counterclockwise; the edge between the last two is cut next
      std::array<unsigned int, 3> vertices;
      unsigned int first; ///< cell of the first mesh that it lies in
      unsigned int level; ///< bisections since then
      std::uint64_t path; ///< a bit of each: which half, the last one lowest
      unsigned int old;   ///< cell at the last settle() that it lies in
      unsigned int other = none; ///< or that it consists of, beside `old`
    };
    /** By the cells of the first mesh and their halves: the order does not
        know in which one they were made. */
    const std::vector<Cell> &cells() const { return cells_; }
    const dealii::Point<2> &vertex(const unsigned int v) const
    {
      return vertices_[v];
    }
    double longest_edge(const Cell &cell) const;

    /**
     * Halves the marked cells, and others where that keeps the mesh conforming.
     * Marked ones that would need a cell of more than @p deepest bisections
     * stay. False: all of them do.
     */
    bool refine(const std::vector<char> &marked, unsigned int deepest = 63);
    /** Halves on all sides of a vertex in the middle of an edge: cells, the
        first half before the second one; one pair at the boundary. */
    struct Family {
      unsigned int vertex;
      std::array<std::array<unsigned int, 2>, 2> pairs{
          {{{none, none}}, {{none, none}}}};
    };
    /** Those that can be joined again so that the mesh stays conforming: they
        have been there at the last settle(). */
    std::vector<Family> families() const;
    /** The cell that two halves are made of. */
    Cell joined(unsigned int first, unsigned int second) const;
    /** Those of @p families become one cell each. */
    void join(const std::vector<Family> &families);

    /** The present cells are the old ones of later ones. */
    void settle();
    /** Vertices of the cells at the last settle(). */
    const std::vector<std::array<unsigned int, 3>> &old_cells() const
    {
      return old_cells_;
    }

    /** The two vertices that @p vertex was put in the middle of; none: it is
        of the first mesh. */
    const std::array<unsigned int, 2> &ends(const unsigned int vertex) const
    {
      return ends_[vertex];
    }

    /** The largest edge that one between two vertices is a part of: of the
        first mesh, or one that bisections have put inside its cells. */
    std::array<unsigned int, 2> whole_edge(unsigned int a,
                                           unsigned int b) const;

    /** The present cells, with the ids of cells and faces of the first ones. */
    CoarseMesh<2> mesh() const;

    /** Four numbers per cell. */
    std::vector<std::uint32_t> ids() const;
    /** Cells of the first mesh become those of ids(). */
    void restore(const std::vector<std::uint32_t> &ids);

    /** An edge by its two vertices, in any order. */
    using Edge = std::uint64_t;
    static Edge edge(unsigned int a, unsigned int b);

  private:
    static Edge cut_edge(const Cell &cell)
    {
      return edge(cell.vertices[1], cell.vertices[2]);
    }
    /// the one or two cells at an edge
    using CellsOf = std::unordered_map<Edge, std::array<unsigned int, 2>>;
    CellsOf cells_of_edges() const;
    unsigned int behind(const CellsOf &cells_of, unsigned int cell,
                        Edge edge) const;
    bool may_cut(const CellsOf &cells_of, unsigned int cell, Edge edge,
                 unsigned int deepest, unsigned int rounds) const;
    std::unordered_set<Edge> closure(const CellsOf &cells_of,
                                     const std::vector<char> &marked) const;
    unsigned int middle(unsigned int a, unsigned int b);
    void halve(const Cell &cell, const std::unordered_set<Edge> &cut,
               std::vector<Cell> &result);

    std::vector<dealii::Point<2>> vertices_;
    std::vector<std::array<unsigned int, 2>> ends_; ///< by vertex, see ends()
    std::vector<Cell> cells_;
    std::vector<std::array<unsigned int, 3>> old_cells_;
    std::vector<dealii::types::material_id> materials_; ///< of the first mesh
    struct Ids {
      dealii::types::boundary_id boundary;
      dealii::types::manifold_id manifold;
    };
    std::unordered_map<Edge, Ids> lines_; ///< those of all levels
    std::unordered_map<Edge, unsigned int> middles_;
  };
} // namespace nsfd
