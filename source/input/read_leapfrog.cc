#include "read_sections.h"

#include <fmt/format.h>

#include <limits>

namespace nsfd
{
  namespace
  {
    /** What explicit steps on joined cells do not know yet. */
    template <typename Block>
    void refuse_lift(SectionReader &reader, const Block &block)
    {
      if (block.sliding.lifts())
        reader.error("scheme",
                     fmt::format("scheme = explicit has no dilatancy and no "
                                 "wear, and `{}` has one of them",
                                 block.name),
                     "remove it, or write scheme = moreau-jean");
    }
  } // namespace

  void read_leapfrog(SectionReader &reader, SceneInput &scene)
  {
    scene.time.scheme = Scheme::leapfrog;
    reader.refuse({"theta", "forecast gamma1", "forecast gamma2",
                   "cohesion rule", "contact target", "sliding",
                   "maximum bisections", "largest overshoot"},
                  "scheme = explicit has none");
    scene.time.largest_overshoot = std::numeric_limits<double>::infinity();
    const auto front = reader.raw(
        "front viscosity", "auto",
        "share of critical damping where the rate of strain jumps between "
        "cells: auto (0.2 if a face can break, else 0) or a number",
        "auto");
    if (front && front->text() != "auto")
      scene.time.front_viscosity = reader.number_in(
          *front, "front viscosity", "0.2", units::none, Range::closed(0., 1.));
    for (InterfaceInput &interface : scene.interfaces) {
      refuse_lift(reader, interface);
      // what holds two cells together are their common nodes
      if (interface.intact == IntactFaces::rigid)
        interface.intact = IntactFaces::bonded;
    }
    for (const ObstacleInput &obstacle : scene.obstacles)
      refuse_lift(reader, obstacle);
    if (scene.statics)
      reader.error("start",
                   "scheme = explicit does not start from an equilibrium yet",
                   "write given");
  }
} // namespace nsfd
