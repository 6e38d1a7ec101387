#pragma once

#include <string>

namespace nsfd::test
{
  /** Joined cells in a standing wave of half length 1 and speed 1, without a
      mesh and a front viscosity. */
  inline const std::string standing_bar = R"(
subsection Material: bar
  set Young modulus = 1
  set Poisson ratio = 0
  set density       = 1
  set initial velocity x = cos(pi * x)
end
subsection Interface: all
  set law = rigid
end
subsection Time
  set end    = 4
  set step   = auto
  set scheme = explicit
end
)";
} // namespace nsfd::test
