#include "read_sections.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    bool follows_time(const BoundaryInput &boundary, const unsigned int dim)
    {
      bool follows = boundary.pressure.depends_on_time();
      for (unsigned int c = 0; c < dim; ++c) {
        follows = follows || boundary.traction[c].depends_on_time();
        if (const auto &u = boundary.displacement[c])
          follows = follows || u->depends_on_time();
        if (const auto &v = boundary.velocity[c])
          follows = follows || !v->is_zero();
      }
      return follows;
    }
  } // namespace

  std::string why_nothing_breaks(const SceneInput &scene)
  {
    const auto &blocks = scene.interfaces;
    if (scene.time.scheme.smooth)
      return "nothing breaks with scheme = arkode";
    if (std::none_of(blocks.begin(), blocks.end(),
                     [](const InterfaceInput &block) { return block.law; }))
      return "no Interface or Obstacle block of this scene has a cohesive law, "
             "and nothing breaks";
    return "";
  }

  void read_events(ParameterFile &file, InputErrors &errors, SceneInput &scene)
  {
    const std::string reason = why_nothing_breaks(scene);
    const auto sections = file.open_blocks("Boundary");
    for (std::size_t b = 0; b < sections.size(); ++b) {
      SectionReader reader(*sections[b], errors);
      BoundaryInput &boundary = scene.boundaries[b];
      if (!reason.empty()) {
        reader.refuse({"hold at"}, reason);
        continue;
      }
      const std::string event = reader.choice(
          "hold at", "never", {"never", "first break", "first face"},
          "from which event on loads keep their values and motions rest: "
          "never, "
          "first break (of a point: beta = 0), or first face (all of its "
          "points)");
      boundary.hold_at = event == "first break"  ? CrackEvent::first_break
                         : event == "first face" ? CrackEvent::first_face
                                                 : CrackEvent::none;
      if (boundary.hold_at == CrackEvent::none)
        continue;
      if (boundary.exact_motion)
        reader.error("hold at",
                     "motion = exact is that of the verification case at all "
                     "times",
                     "remove one of the two");
      else if (!follows_time(boundary, scene.dimension))
        reader.error("hold at",
                     "nothing of this block changes with time, and nothing is "
                     "left to hold",
                     "give it a formula of t or a velocity, or remove `hold "
                     "at`");
    }
  }
} // namespace nsfd
