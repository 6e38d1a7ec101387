#pragma once

#include "named_mesh.h"

#include <string>
#include <vector>

namespace nsfd
{
  /**
   * An Exodus file, not yet in order: element blocks, side sets and node sets
   * are groups, by name or number; the element variables of the last time are
   * fields. In this process: HDF5 may crash on damaged files.
   */
  NamedMesh read_exodus_here(const std::string &file, unsigned int dimension,
                             std::vector<std::string> &problems);
} // namespace nsfd
