#pragma once

#include "drive_point.h"
#include "read_law.h"

#include <string>
#include <vector>

namespace nsfd
{
  using Curve = std::vector<CurveRow>;

  /** Traction against the jump: SVG of all curves. */
  std::string traction_chart(const LawInput &input,
                             const std::vector<Curve> &curves);

  /** Where the work went: against the jump, or the path if it turns back. */
  std::string energy_chart(const LawInput &input,
                           const std::vector<Curve> &curves);
} // namespace nsfd
