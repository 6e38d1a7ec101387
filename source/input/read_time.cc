#include "read_sections.h"

#include "time_integration/step_entry.h"
#include "time_integration/time_scheme.h"

#include <fmt/format.h>

namespace nsfd
{
  namespace
  {
    /** Laws with rates, and contacts that sliding moves. */
    void refuse_rates(SectionReader &reader, const SceneInput &scene)
    {
      const auto refuse_lift = [&reader](const auto &block) {
        if (block.sliding.lifts())
          reader.error("start",
                       fmt::format("equilibria with dilatancy or wear (`{}`) "
                                   "are not available",
                                   block.name),
                       "remove them, or start as given");
      };
      for (const InterfaceInput &interface : scene.interfaces) {
        if (interface.law && interface.law->rate_dependent())
          reader.error("start",
                       fmt::format("an equilibrium has no rates, and the law "
                                   "of `{}` has a damage viscosity",
                                   interface.name),
                       "remove its damage viscosity");
        if (interface.law && interface.law->heals())
          reader.error("start",
                       fmt::format("an equilibrium has no time in which the "
                                   "law of `{}` could heal",
                                   interface.name),
                       "remove its healing time, or start as given");
        refuse_lift(interface);
      }
      for (const ObstacleInput &obstacle : scene.obstacles)
        refuse_lift(obstacle);
    }

    /** An equilibrium at the start, and what it cannot go with. */
    bool read_start(SectionReader &reader, const SceneInput &scene,
                    const TimeScheme &scheme)
    {
      const bool quasi_static = scheme.is_static();
      const std::string start =
          reader.choice("start", quasi_static ? "equilibrium" : "given",
                        {"given", "equilibrium"}, "given or equilibrium");
      if (start == "given") {
        if (quasi_static)
          reader.error("start",
                       "quasi-static steps go from one equilibrium to "
                       "the next, also the first one",
                       "write: equilibrium");
        return false;
      }
      if (all_rigid(scene))
        reader.error("start",
                     "an equilibrium needs a body that deforms: all materials "
                     "are rigid",
                     "remove `start` and `scheme`, or the entry `model = "
                     "rigid` of a material");
      if (scene.large_motion) {
        reader.error("start",
                     "equilibria of scenes with motion = large are not there "
                     "yet",
                     "write given, and let the scene come to rest");
        return true;
      }
      if (scene.has_history()) {
        reader.error("start",
                     fmt::format("equilibria of scenes with {} are not there "
                                 "yet",
                                 history_dependent_model(scene)),
                     "write given, and let the scene come to rest");
        return true;
      }
      refuse_rates(reader, scene);
      for (const MaterialInput &material : scene.materials)
        for (unsigned int c = 0; c < scene.dimension; ++c)
          if (!material.initial_velocity[c].is_zero()) {
            reader.error("start",
                         fmt::format("an equilibrium is at rest, and material "
                                     "`{}` has an initial velocity",
                                     material.name),
                         "keep one of the two");
            return true;
          }
      return true;
    }

    void read_rest(SectionReader &reader, SceneInput &scene)
    {
      const std::string reason = why_nothing_breaks(scene);
      if (!reason.empty())
        return reader.refuse({"end at rest"}, reason);
      scene.time.rest_steps = reader.integer(
          "end at rest", "0", 0, 1000000000,
          "accepted steps without a point that breaks, after the first one "
          "that has, with which the run ends before `end`; 0: never");
    }

    /** Not every scheme iterates within a step; true if this is one of them. */
    bool refuse_scheme(SectionReader &reader, const SceneInput &scene,
                       const TimeScheme &scheme)
    {
      if (!scene.iterates() || scheme.takes_nonlinear_bodies())
        return false;
      reader.error("scheme",
                   fmt::format("scheme = {} is not available for {}",
                               scene.time.scheme_name,
                               scene.large_motion
                                   ? "motion = large"
                                   : history_dependent_model(scene)),
                   "write scheme = moreau-jean");
      reader.accept_everything();
      return true;
    }

    std::string list_of(const std::vector<std::string> &names)
    {
      const std::size_t last = names.size() - 1;
      return fmt::format("{} or {}",
                         fmt::join(names.begin(), names.begin() + last, ", "),
                         names[last]);
    }
  } // namespace

  void look_at_scheme(const ParameterFile &file, SceneInput &scene)
  {
    const ParameterSection *section = file.find("Time");
    const ParameterEntry *entry = section ? section->find("scheme") : nullptr;
    const ParameterEntry *start = section ? section->find("start") : nullptr;
    const auto scheme = entry ? find_time_scheme(entry->value.text()) : nullptr;
    if (scheme)
      scene.time.scheme = scheme->traits();
    const bool steps = scheme && scheme->is_static();
    if (steps || (start && start->value.text() == "equilibrium")) {
      scene.statics.emplace(); // read_time() reads what it is
      scene.statics->steps = steps;
    }
  }

  void read_time(ParameterFile &file, InputErrors &errors, SceneInput &scene)
  {
    SectionReader reader(file.open("Time"), errors);
    TimeInput &time = scene.time;
    time.end = reader.number("end", "", units::time, Range::positive(), "s");
    std::vector<std::string> names = time_scheme_names();
    const std::string text = list_of(names) +
                             "; auto, the default of motion = large and where "
                             "no `step` is given: explicit or moreau-jean, "
                             "what is predicted to come to `end` at less cost";
    // read_scene() reads it as one of the two
    names.push_back("auto");
    time.scheme_name = reader.choice("scheme", names.front(), names, text);
    const auto scheme = find_time_scheme(time.scheme_name);
    time.scheme = scheme->traits();
    scene.statics.reset();
    if (refuse_scheme(reader, scene, *scheme))
      return;
    scheme->demand(reader, scene);
    if (read_start(reader, scene, *scheme)) {
      scene.statics.emplace();
      scene.statics->tolerance =
          reader.number("equilibrium tolerance", "1e-11", units::none,
                        {0., 1e-3, true, false},
                        "unbalanced force, relative to the forces present");
    } else
      reader.refuse({"equilibrium tolerance"},
                    "no equilibrium is computed in this scene");
    scheme->read_steps(reader, scene);
    read_rest(reader, scene);
    refuse_other_entries(reader, time.scheme_name);
    scheme->read(reader, scene);
  }

  std::vector<NamedText> known_time_schemes()
  {
    std::vector<NamedText> schemes;
    for (const std::string &name : time_scheme_names())
      schemes.push_back(
          {name, TimeSchemeRegistry::instance().entries().at(name).text});
    return schemes;
  }
} // namespace nsfd
