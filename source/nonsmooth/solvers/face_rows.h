#pragma once

#include <cstddef>
#include <vector>

namespace nsfd
{
  /** Rows of H at the points of a face, and the unknowns that they see. */
  struct FaceRows {
    std::size_t first = 0; ///< of its points, which are consecutive
    unsigned int count = 0;
    std::vector<int> dofs;    ///< ascending
    std::vector<double> rows; ///< dim per point x dofs, in the local frame
  };
} // namespace nsfd
