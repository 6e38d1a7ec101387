#pragma once

#include "input/read_scene.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace nsfd::large_motion_scenes
{
  const std::string space = R"(# drum - a ball and a soft block in a drum
set dimension = 3
set motion = large
subsection Mesh
  set type = brick
  set upper corner = 3 mm, 1 mm, 1 mm
  set cells = 3, 1, 1
end
subsection Material: stone
  set where = x < 1 mm
  set model = rigid
  set density = 2 g/cm^3
  set bodies = connected
  set surface = ball
  set mass = 3 mg
  set principal inertia = 1 g*mm^2, 2 g*mm^2, 3 g*mm^2
end
subsection Material: rubber
  set where = x < 2 mm
  set model = neo-hookean
  set Young modulus = 1 MPa
  set Poisson ratio = 0.45
  set density = 1 g/cm^3
end
subsection Material: steel
  set model = saint-venant kirchhoff
  set Young modulus = 200 GPa
  set Poisson ratio = 0.3
  set density = 7.8 g/cm^3
end
subsection Interface: seam
  set law = camacho-ortiz
  set strength = 1 MPa
  set toughness = 1 J/m^2
  set friction = 0.5
  set dilatancy = 0.1
  set opening viscosity = 1 Pa*s/m
  set crack pressure = 1 kPa
end
subsection Boundary: right
  set pressure = 1 kPa
end
subsection Obstacle: floor
  set point = 0, 0, -1 mm
  set normal = 0, 3, 4
end
subsection Obstacle: drum
  set shape = cylinder
  set point = 0, 0, 1 mm
  set axis = 0, 0, 2
  set radius = 1 cm
  set hollow = true
end
subsection Obstacle: hammer
  set shape = sphere
  set point = 9 mm, 1 mm, 2 mm
  set radius = 2 mm
  set velocity x = -3 m/s * cos(t / 1 ms)
  set velocity z = 1 m/s
  set restitution = 0.5
end
subsection Contact: stone on rubber
  set between = [stone, rubber]
  set friction = 0.7
  set wear coefficient = 1e-6 1/MPa
end
subsection Contact: others
  set restitution = 0.25
end
subsection Pin: hinge
  set material = stone
  set at = 1 mm, 2 mm, 3 mm
end
subsection Time
  set end = 1 ms
  set step = 1 us
end
subsection Solver
  set path = auto
end
)";

  const std::string plane = R"(# disc - a disc beside a strip
set dimension = 2
set plane = stress
set motion = large
subsection Mesh
  set upper corner = 2 km, 1 km
  set cells = 2, 1
end
subsection Material: rock
  set where = x < 1 km
  set model = rigid
  set density = 2 g/cm^3
end
subsection Material: ice
  set model = saint-venant kirchhoff
  set Young modulus = 9 GPa
  set Poisson ratio = 0.3
  set density = 0.9 g/cm^3
end
subsection Interface: all
  set law = contact
end
subsection Obstacle: hill
  set shape = sphere
  set point = 1 km, -5 km
  set radius = 4 km
end
subsection Time
  set end = 1 s
end
)";

  const std::string small = R"(# still - small motions
set dimension = 2
subsection Mesh
  set upper corner = 2, 1
  set cells = 2, 1
end
subsection Material: rock
  set where = x < 1
  set model = rigid
  set density = 1
end
subsection Material: ice
  set Young modulus = 1
  set Poisson ratio = 0.3
  set density = 1
end
subsection Interface: all
  set law = rigid
end
subsection Obstacle: floor
  set shape = plane
  set point = 0, 0
  set normal = 0, 1
end
subsection Time
  set end = 1
end
)";

  inline std::string replaced(std::string text, const std::string &from,
                              const std::string &to)
  {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << "no `" << from << "`";
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
  }

  inline std::unique_ptr<SceneInput>
  read_good(const std::string &text,
            const std::vector<std::string> &overrides = {})
  {
    InputErrors errors;
    auto scene = read_scene_text(text, "good.prm", overrides, errors);
    EXPECT_EQ(errors.report(), "");
    return scene;
  }

  const std::string rigid_stone = "set bodies = connected";
  const std::string inertia =
      "set principal inertia = 1 g*mm^2, 2 g*mm^2, 3 g*mm^2";
  const std::string pair = "set between = [stone, rubber]";
} // namespace nsfd::large_motion_scenes
