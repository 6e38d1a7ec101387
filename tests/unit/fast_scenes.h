#pragma once

#include <string>

// Scenes of bodies that pass each other by more than their thickness.

namespace nsfd::test::fast
{
  /** Both have 10 kg per metre, 50 mm between them. */
  inline const std::string shot_and_foil = R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type = bodies
end
subsection Body: shot
  set type         = rectangle
  set lower corner = 0, -0.05
  set upper corner = 0.1, 0.05
  set cells        = 1, 1
end
subsection Body: foil
  set type         = rectangle
  set lower corner = 0.15, -0.5
  set upper corner = 0.16, 0.5
  set cells        = 1, 1
end
subsection Material: shot
  set where              = shot
  set model              = rigid
  set density            = 1000
  set initial velocity x = 10
end
subsection Material: foil
  set where   = foil
  set model   = rigid
  set density = 1000
end
subsection Interface: all
  set law = rigid
end
subsection Contact: all
  set friction = 0
end
subsection Time
  set end  = 1
  set step = 1 ms
end
)";

  inline const std::string balls = R"(
set dimension = 3
set motion    = large
subsection Mesh
  set type = bodies
end
subsection Body: one
  set type         = brick
  set lower corner = -0.5, -0.5, -0.5
  set upper corner = 0.5, 0.5, 0.5
  set cells        = 1, 1, 1
end
subsection Body: two
  set type         = brick
  set lower corner = 4.5, -0.5, -0.5
  set upper corner = 5.5, 0.5, 0.5
  set cells        = 1, 1, 1
end
subsection Material: one
  set where              = one
  set model              = rigid
  set bodies             = connected
  set surface            = ball
  set mass               = 1
  set density            = 1
  set initial velocity x = 1
end
subsection Material: two
  set where   = two
  set model   = rigid
  set bodies  = connected
  set surface = ball
  set mass    = 3
  set density = 1
end
subsection Interface: all
  set law = rigid
end
subsection Contact: all
  set friction = 0
end
subsection Time
  set end  = 100
  set step = 1
end
)";

  inline const std::string wire = R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type         = rectangle
  set lower corner = -0.1, -0.1
  set upper corner = 0.1, 0.1
  set cells        = 1, 1
end
subsection Material: m
  set model              = rigid
  set bodies             = connected
  set surface            = ball
  set density            = 1000
  set initial velocity x = 10
end
subsection Interface: all
  set law = rigid
end
subsection Obstacle: wire
  set shape    = sphere
  set where    = all
  set point    = 0.8, 0
  set radius   = 5 mm
  set friction = 0
end
subsection Time
  set end  = 1
  set step = 1 ms
end
)";

  inline const std::string rod_and_disc = R"(
set dimension = 2
set motion    = large
subsection Mesh
  set type = bodies
end
subsection Body: rod
  set type         = rectangle
  set lower corner = -1, -0.02
  set upper corner = 1, 0.02
  set cells        = 1, 1
end
subsection Body: disc
  set type         = rectangle
  set lower corner = -0.05, 0.65
  set upper corner = 0.05, 0.75
  set cells        = 1, 1
end
subsection Material: rod
  set where              = rod
  set model              = rigid
  set density            = 1000
  set initial velocity x = -y
  set initial velocity y = x
end
subsection Material: disc
  set where   = disc
  set model   = rigid
  set bodies  = connected
  set surface = ball
  set mass    = 20
  set density = 1000
end
subsection Interface: all
  set law = rigid
end
subsection Contact: all
  set friction = 0
end
subsection Time
  set end  = 10
  set step = 1
end
)";
} // namespace nsfd::test::fast
