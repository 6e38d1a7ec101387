#pragma once

#include "nsfd/parameters/expression.h"
#include "nsfd/scene/where_input.h"

#include <array>
#include <optional>
#include <string>

namespace nsfd
{
  /** From which event on the formulas of a block stay as they are then. */
  enum class CrackEvent {
    none,
    first_break, ///< a point that held at the start is broken, beta = 0
    first_face   ///< a face is, at all of its points
  };

  struct BoundaryInput {
    std::string name;
    Where where;
    /// prescribed motion per component: velocity, or displacement (then its
    /// time derivative is what the rows prescribe, exactly per step)
    std::array<std::optional<Expression>, 3> velocity, displacement;
    std::array<Expression, 3> traction; ///< Pa, per component
    bool has_traction = false;
    Expression pressure; ///< Pa, positive pushes on the body
    bool has_pressure = false;
    bool exact_motion = false; ///< of the verification case
    /// of x, y, z, t; at most one of them
    std::optional<Expression> temperature; ///< K
    std::optional<Expression> heat_flux;   ///< W/m^2 into the body
    bool absorbs = false; ///< waves that come in along the normal
    CrackEvent hold_at = CrackEvent::none;
  };
} // namespace nsfd
