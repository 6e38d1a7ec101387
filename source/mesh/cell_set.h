#pragma once

namespace nsfd
{
  /** Which cells of a mesh a rank looks at. */
  enum class CellSet {
    own,
    with_ghosts ///< those too that share a vertex with one of its own
  };
} // namespace nsfd
