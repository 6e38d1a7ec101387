#pragma once

#include "two_blocks.h"

#include <string>

// Scenes with joints, supports and contacts whose rows depend on each other.

namespace nsfd::test
{
  /** Three joined cells whose top is driven: cells that share a node ask for
      the same there twice, once by the support and once by the joint. */
  inline const std::string driven = R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set upper corner = 1, 1
  set cells        = 3, 1
end
subsection Material: m
  set model         = saint-venant kirchhoff
  set Young modulus = 1e6
  set Poisson ratio = 0.3
  set density       = 1000
end
subsection Interface: joined
  set law = rigid
end
subsection Boundary: head
  set where      = top
  set velocity x = 0.3 * t
  set velocity y = 0
end
subsection Time
  set end  = 2
  set step = 5 ms
end
)";

  /** Meshes do not match, slowly pressed. */
  inline const std::string pressed = two_blocks + R"(
subsection Material: m
  set model         = saint-venant kirchhoff
  set Young modulus = 1 GPa
  set Poisson ratio = 0
  set density       = 1000
end
subsection Interface: joined
  set law = rigid
end
subsection Contact: c
  set between = all
end
subsection Boundary: foot
  set where = y < 1 um
  set velocity y = 0
end
subsection Boundary: head
  set where = y > 99.999 mm
  set velocity y = if(t < 10 ms, -0.01, 0)
end
subsection Time
  set end  = 12 ms
  set step = 10 us
  set theta = 0.7
end
)";

  /** A small block on a long one. */
  inline const std::string dragged = R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type = bodies
end
subsection Body: base
  set type         = rectangle
  set lower corner = 0, 0
  set upper corner = 30 mm, 5 mm
  set cells        = 12, 2
end
subsection Body: slider
  set type         = rectangle
  set lower corner = 5 mm, 5 mm
  set upper corner = 12 mm, 10 mm
  set cells        = 3, 2
end
subsection Material: lower
  set where         = base
  set model         = saint-venant kirchhoff
  set Young modulus = 1 GPa
  set Poisson ratio = 0.3
  set density       = 1000 kg/m^3
end
subsection Material: upper
  set where         = slider
  set model         = saint-venant kirchhoff
  set Young modulus = 1 GPa
  set Poisson ratio = 0.3
  set density       = 1000 kg/m^3
end
subsection Interface: joined
  set law = rigid
end
subsection Contact: slide
  set between  = [lower, upper]
  set friction = 0.5
end
subsection Boundary: base foot
  set where = y < 1 um
  set velocity x = 0
  set velocity y = 0
end
subsection Boundary: slider top
  set where = y > 9.999 mm
  set velocity x = 5 m/s * min(t/0.2 ms, 1)
  set velocity y = if(t < 0.1 ms, -0.1 m/s, 0)
end
subsection Time
  set end  = 2 ms
  set step = 2 us
  set theta = 0.6
end
)";
} // namespace nsfd::test
