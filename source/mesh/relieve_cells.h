#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace nsfd
{
  /**
   * Moves the nodes of the worst triangles or tetrahedra a
   * little, until their smallest angle and their lowest height, once they are
   * cut, are as those of all others: a few low cells would decide the stable
   * step. @p held has a bit for each coordinate of a node that stays, @p size
   * is how far apart nodes shall be there. Cells stay what they are, and become
   * no worse.
   */
  template <int dim>
  void
  relieve_cells(std::vector<std::array<double, dim>> &nodes,
                const std::vector<unsigned char> &held,
                const std::vector<std::array<unsigned int, dim + 1>> &corners,
                const std::vector<double> &size);
} // namespace nsfd
