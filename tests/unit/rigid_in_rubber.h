#pragma once

#include <string>

namespace nsfd
{
  namespace test
  {
    /** 12 x 6 squares; 4 x 6 of them are one rigid body. */
    inline const std::string rigid_in_rubber = R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set upper corner = 12, 6
  set cells        = 12, 6
end
subsection Material: block
  set where   = x > 3 && x < 7
  set model   = rigid
  set bodies  = connected
  set density = 1
end
subsection Material: rubber
  set model         = neo-hookean
  set Young modulus = 100
  set Poisson ratio = 0.3
  set density       = 1
end
subsection Interface: all
  set law                  = elastic
  set normal stiffness     = 1e4
  set tangential stiffness = 1e4
end
subsection Time
  set end  = 1
  set step = 0.01
end
)";
  } // namespace test
} // namespace nsfd
