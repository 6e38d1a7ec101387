#pragma once

#include "input/read_scene.h"

#include <gtest/gtest.h>

#include <ostream>
#include <sstream>
#include <string>
#include <vector>

// Wrong input is refused before anything runs, at the right line, with a
// message that names parameter and value. Every case changes one place of a
// scene that is right.

namespace nsfd::changed_scene
{
  const std::string base_file =
      R"(# base - one plane may break
set dimension = 2
set plane = strain
subsection Constants
  set size = 10 um
  set stiffness = 2
end
subsection Mesh
  set type = rectangle
  set lower corner = 0, 0
  set upper corner = size, 10 um
  set cells = 4, 4
end
subsection Discretization
  set degree = 1
  set mass = consistent
end
subsection Material: bulk
  set Young modulus = 135 GPa
  set Poisson ratio = 0.32
  set density = 7800 kg/m^3
end
subsection Interface: midline
  set where = abs(x - 5 um) < 1 nm
  set law = camacho-ortiz
  set strength = 300 MPa
  set toughness = 0.5 J/m^2
  set friction = 0
end
subsection Interface: elsewhere
  set law = rigid
end
subsection Boundary: left
  set velocity x = -2 m/s
end
subsection Obstacle: floor
  set point = 0, 0
  set normal = 0, 1
  set restitution = 0.5
end
subsection Time
  set end = 10 ns
  set step = 0.6 courant
  set theta = 0.5
end
subsection Solver
  set method = auto
end
subsection Output
  set fields every = 0.5 ns
end
)";

  struct BadInput {
    std::string name;
    std::string old_text; ///< part of the base file, replaced by new_text
    std::string new_text;
    std::string message; ///< part of the report
    std::string place;   ///< part of the line that is blamed; empty: none
  };

  /** For the names that GoogleTest prints. */
  inline void PrintTo(const BadInput &bad, std::ostream *stream)
  {
    *stream << bad.name;
  }

  inline std::string with_change(const BadInput &change)
  {
    const std::size_t at = base_file.find(change.old_text);
    EXPECT_NE(at, std::string::npos) << "no `" << change.old_text << "`";
    std::string text = base_file;
    return text.replace(at, change.old_text.size(), change.new_text);
  }

  /** Line 1 is the first one; line 0 is empty. */
  inline std::string line_of(const std::string &text, const unsigned int number)
  {
    std::istringstream stream(text);
    std::string line;
    for (unsigned int i = 0; i < number; ++i)
      std::getline(stream, line);
    return line;
  }
} // namespace nsfd::changed_scene
