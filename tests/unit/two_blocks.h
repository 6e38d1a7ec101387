#pragma once

#include <string>

namespace nsfd::test
{
  /** A block of 3 x 5 cells on one of 4 x 5: nodes do not match. Both are 20 mm
      wide and 50 mm high, large motion. */
  inline const std::string two_blocks = R"(
set dimension = 2
set motion = large
subsection Mesh
  set type = bodies
end
subsection Body: outer
  set type         = rectangle
  set lower corner = 0, 0
  set upper corner = 20 mm, 50 mm
  set cells        = 4, 5
end
subsection Body: inner
  set type         = rectangle
  set lower corner = 0, 50 mm
  set upper corner = 20 mm, 100 mm
  set cells        = 3, 5
end
)";
} // namespace nsfd::test
