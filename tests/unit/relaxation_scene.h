#pragma once

#include <string>

namespace nsfd::test
{
  /**
   * One cell of 1 mm without stiffness on a cohesive face of a heavy one: mass
   * rho L/2 per area, one solution below 3.1062e-6 s (`end point`).
   */
  inline const std::string relaxation_scene = R"(set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 2 mm, 1 mm
  set cells        = 2, 1
end
subsection Discretization
  set mass                 = lumped
  set interface quadrature = gauss lobatto
end
subsection Material: anvil
  set where         = x < 1 mm
  set Young modulus = 1e-9
  set Poisson ratio = 0
  set density       = 2.5e15
end
subsection Material: mass
  set Young modulus = 1e-9
  set Poisson ratio = 0
  set density       = 2500
end
subsection Interface: middle
  set law       = michel-suquet
  set strength  = 1 MPa
  set toughness = 10 J/m^2
end
subsection Time
  set end   = 1 ms
  set step  = 1 us
  set theta = 1
  set cohesion rule = end point
end
)";
} // namespace nsfd::test
