#pragma once

#include <string>
#include <vector>

namespace nsfd
{
  struct NamedMesh;

  /**
   * What makes a mesh no mesh: cells that are inverted or flat, two cells on
   * the same side of the face that they share (a fold), cells that overlap by
   * more than a tenth of the thinner one (less is what curved bodies have that
   * were meshed each by itself). Cells are named by their number in the file
   * and their centre. O(n log n).
   */
  void check_cells(const NamedMesh &mesh, std::vector<std::string> &problems);

  /** "cell 12 at (1, 2)" */
  std::string cell_text(const NamedMesh &mesh, std::size_t cell);
} // namespace nsfd
