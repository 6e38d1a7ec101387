#pragma once

#include "nsfd/parameters/expression.h"

#include <array>
#include <string>

namespace nsfd
{
  /** `where`: all | boundary or material words | a group | a condition. */
  struct Where {
    enum class Kind {
      all,
      side,  ///< left right bottom top back front of the bounding box
      group, ///< a named group of the mesh (material or boundary id)
      between_materials, ///< faces between two material blocks
      between_groups,    ///< faces between two groups of cells
      expression         ///< non-zero at the midpoint of face or cell
    };
    Kind kind = Kind::all;
    std::string name; ///< side or group
    /// names, of materials or groups; empty = any two different
    std::array<std::string, 2> materials;
    Expression condition;
  };
} // namespace nsfd
