#pragma once

#include <array>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * The shapes of cells that files bring: how their corners hang together, in
   * deal.II's order. Every corner of a cell in d dimensions is on d edges.
   */
  struct CellShapeTopology {
    std::string name; ///< plural
    unsigned int dimension, n_corners;
    /// per corner: those at the other ends of its edges, such that the edges
    /// make a right-handed system
    std::vector<std::vector<unsigned int>> edges;
    std::vector<std::vector<unsigned int>> faces; ///< corners of each
    std::vector<unsigned int> mirrored; ///< corners of the mirror image
  };

  /** Null if there is no such shape. */
  const CellShapeTopology *find_cell_shape(unsigned int dimension,
                                           unsigned int n_corners);
} // namespace nsfd
