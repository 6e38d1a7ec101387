#pragma once

namespace end_to_end
{
  /** A block that slides over a plane, pressed on it on the right and torn up
      on the left, where its faces break. */
  const char *const rubbing_block = R"(
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 40 mm, 20 mm
  set cells        = 8, 4
end
subsection Material: lining
  set Young modulus    = 2 GPa
  set Poisson ratio    = 0.3
  set density          = 2000 kg/m^3
  set heat capacity    = 800 J/kg/K
  set conductivity     = 2 W/m/K
  set initial velocity x = 10 m/s
end
subsection Interface: all
  set law                 = camacho-ortiz
  set strength            = 2 MPa
  set toughness           = 20 J/m^2
  set friction            = 0.4
  set contact conductance = 5 kW/m^2/K
end
subsection Obstacle: disc
  set where      = bottom
  set point      = 0, 0
  set normal     = 0, 1
  set friction   = 0.4
end
subsection Boundary: left
  set where      = y > 19.99 mm && x < 15 mm
  set velocity x = 10 m/s
  set velocity y = 0.5 m/s
end
subsection Boundary: right
  set where      = y > 19.99 mm && x > 15 mm
  set velocity x = 10 m/s
  set velocity y = -0.1 m/s
end
subsection Time
  set end = 0.2 ms
end
)";
} // namespace end_to_end
