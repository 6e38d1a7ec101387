#pragma once

#include <string>

namespace nsfd::test
{
  /** Elastic cells of any shape that run into each other, break and rub. */
  inline const std::string breaking_plate = R"(# plate - breaks and rubs.
set dimension = 2
subsection Mesh
  set lower corner = 0, 0
  set upper corner = 2, 1
  set cells        = 6, 3
  set distortion   = 0.2
end
subsection Material: plate
  set Young modulus      = 100
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = 0.8 * sin(4 * x)
end
subsection Interface: all
  set law              = michel-suquet
  set stiffness        = 2000
  set strength         = 4
  set strength scatter = 0.3
  set friction         = 0.4
end
subsection Time
  set end  = 1
  set step = 0.2 courant
end
)";
} // namespace nsfd::test
