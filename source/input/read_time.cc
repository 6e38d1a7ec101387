#include "read_sections.h"

#include "parameters/former_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace nsfd
{
  namespace
  {
    /** Splits "0.6 courant" into "0.6" and "courant". */
    std::pair<SourceText, std::string> split_last_word(const SourceText &value)
    {
      const std::size_t begin = begin_of_last_word(value.text());
      return {value.part(0, begin), value.text().substr(begin)};
    }

    void read_step(SectionReader &reader, const std::string &name,
                   TimeInput &time)
    {
      const auto value = reader.raw(
          name, "0.5 courant",
          "a time, a Courant number h c_p / L of the smallest cell, or auto");
      if (!value || value->text() == "auto") {
        time.step_kind = StepKind::automatic;
        return;
      }
      const auto [number, word] = split_last_word(*value);
      const std::string meant = did_you_mean_today(
          word, {"courant"}, FormerWord::Place::unit, "Time", name);
      if (word == "courant") {
        time.step_kind = StepKind::courant;
        time.step = reader.number_in(number, name, "0.5 courant", units::none,
                                     Range::positive());
      } else if (!find_unit(word) && !meant.empty())
        reader.error(name,
                     fmt::format("{} = {}: `{}` is not a unit", name,
                                 value->text(), word),
                     meant);
      else if (nearest_name(value->text(), {"auto"}) == "auto")
        reader.error(name,
                     fmt::format("{} = {} is not a step", name, value->text()),
                     "did you mean `auto`?");
      else {
        time.step_kind = StepKind::time;
        time.step = reader.number_in(*value, name, "0.5 courant", units::time,
                                     Range::positive());
      }
    }

    bool all_rigid(const SceneInput &scene)
    {
      return !scene.materials.empty() &&
             std::all_of(scene.materials.begin(), scene.materials.end(),
                         [](const MaterialInput &m) { return m.rigid; });
    }

    void check_step(SectionReader &reader, const SceneInput &scene)
    {
      if (all_rigid(scene) && scene.time.step_kind != StepKind::time)
        reader.error("step",
                     "the step must be a time: all materials are rigid, and no "
                     "wave crosses a cell",
                     "write for example: set step = 1 us");
    }

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
        if (interface.intact == IntactFaces::bonded)
          reader.error("start",
                       fmt::format("equilibria with bonded faces (`{}`) are "
                                   "not available",
                                   interface.name),
                       "write rigid, or start as given");
        if (interface.law && interface.law->rate_dependent())
          reader.error("start",
                       fmt::format("an equilibrium has no rates, and the law "
                                   "of `{}` has a damage viscosity",
                                   interface.name),
                       "remove its damage viscosity");
        refuse_lift(interface);
      }
      for (const ObstacleInput &obstacle : scene.obstacles)
        refuse_lift(obstacle);
    }

    /** The energy that it misses is of the order of its square. */
    void read_overshoot(SectionReader &reader, SceneInput &scene)
    {
      const std::string name = "largest overshoot";
      const auto breaks = [](const InterfaceInput &block) {
        return block.law && block.intact == IntactFaces::bonded;
      };
      if (std::none_of(scene.interfaces.begin(), scene.interfaces.end(),
                       breaks)) {
        reader.refuse({name}, "there are no bonded faces that may break");
        return;
      }
      if (scene.time.scheme == Scheme::explicit_moreau_jean) {
        // the fastest modes take energy from every change of an explicit step
        scene.time.largest_overshoot = std::numeric_limits<double>::infinity();
        reader.refuse({name}, "explicit steps are not bisected for it");
        return;
      }
      scene.time.largest_overshoot = reader.number(
          name, "0.05", units::none, Range::positive(),
          "of a bonded point over its strength; beyond it the step is "
          "rejected and bisected");
    }

    /** An equilibrium at the start, and what it cannot go with. */
    bool read_start(SectionReader &reader, const SceneInput &scene,
                    const bool quasi_static)
    {
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

    /** `step` of the load, and where quasi-static steps end. */
    void read_quasi_static(SectionReader &reader, SceneInput &scene)
    {
      TimeInput &time = scene.time;
      StaticInput &statics = *scene.statics;
      statics.steps = true;
      const auto step = reader.raw("step", "", "a time: of the load", "1 ms");
      if (step) {
        const std::string word = split_last_word(*step).second;
        if (word == "auto" || word == "courant")
          reader.error("step",
                       fmt::format("step = {}: a quasi-static step is a time "
                                   "of the load, no wave counts in it",
                                   step->text()),
                       "write for example: set step = 1 ms");
        else
          statics.step = reader.number_in(*step, "step", "1 ms", units::time,
                                          Range::positive());
      }
      statics.until = time.end;
      if (reader.optional("quasi-static until",
                          "s; Moreau-Jean steps after it"))
        statics.until = reader.number("quasi-static until", "", units::time,
                                      {0., time.end, true, false},
                                      "s; Moreau-Jean steps after it");
      const std::string at_jump = reader.choice(
          "at solution jump", "stop", {"stop", "dynamic", "relax"},
          "where no equilibrium continues the last: stop, dynamic or relax");
      statics.at_jump = at_jump == "dynamic" ? SolutionJump::dynamic
                        : at_jump == "relax" ? SolutionJump::relax
                                             : SolutionJump::stop;
      if (scene.may_move())
        read_step(reader, "dynamic step", time);
      else {
        reader.refuse({"dynamic step"},
                      "no step of this scene is dynamic: neither `quasi-static "
                      "until` nor `at solution jump = dynamic` is there");
        time.step_kind = StepKind::time;
        time.step = statics.step > 0. ? statics.step : time.end;
      }
      for (const InterfaceInput &interface : scene.interfaces)
        if (interface.opening_viscosity > 0.)
          reader.warning("scheme",
                         fmt::format("an equilibrium has no rates: the opening "
                                     "viscosity of `{}` takes no part in "
                                     "quasi-static steps",
                                     interface.name));
    }

    void read_theta(SectionReader &reader, const SceneInput &scene,
                    TimeInput &time)
    {
      const unsigned int n_before = reader.errors().n_errors();
      time.theta = reader.number("theta", "0.5", units::none, Range::any(),
                                 "1/2 conserves energy, 1 damps");
      if (reader.errors().n_errors() > n_before)
        return;
      if (time.theta < 0.5)
        reader.error("theta",
                     fmt::format("theta = {:g} must be at least 0.5: below it "
                                 "every step grows, as forward Euler does",
                                 time.theta),
                     "write for example: 0.5");
      if (time.theta > 1.)
        reader.error("theta",
                     fmt::format("theta = {:g} must be at most 1", time.theta),
                     "write for example: 0.5");

      double restitution = 0.;
      for (const InterfaceInput &interface : scene.interfaces)
        restitution = std::max(restitution, interface.restitution);
      for (const ObstacleInput &obstacle : scene.obstacles)
        restitution = std::max(restitution, obstacle.restitution);
      for (const ContactInput &contact : scene.contacts)
        restitution = std::max(restitution, contact.restitution);
      const double bound = 1. / (1. + restitution);
      if (time.theta > bound && time.theta <= 1.)
        reader.warning("theta",
                       fmt::format("theta = {:g} is above 1/(1 + e) = {:g} for "
                                   "restitution e = {:g}: impacts can create "
                                   "energy",
                                   time.theta, bound, restitution),
                       fmt::format("write at most {:g}", bound));
    }

    /** Nothing may open, close or slip. */
    void check_smooth(SectionReader &reader, const SceneInput &scene)
    {
      for (const InterfaceInput &interface : scene.interfaces) {
        const bool smooth =
            interface.law_name == "rigid" || interface.law_name == "bonded" ||
            (interface.law_name == "elastic" &&
             interface.intact == IntactFaces::spring && !interface.has_broken);
        if (!smooth)
          reader.error("scheme",
                       fmt::format("scheme = arkode is for smooth motion, and "
                                   "faces of `Interface: {}` can open, close "
                                   "or slip",
                                   interface.name),
                       "write law = bonded, rigid or elastic there, or scheme "
                       "= moreau-jean");
      }
      for (const ObstacleInput &obstacle : scene.obstacles)
        reader.error("scheme",
                     fmt::format("scheme = arkode is for smooth motion, and "
                                 "`Obstacle: {}` can be touched",
                                 obstacle.name),
                     "write scheme = moreau-jean");
    }

    /** Runge-Kutta pairs of SUNDIALS for scenes without events. */
    void read_smooth(SectionReader &reader, SceneInput &scene)
    {
      TimeInput &time = scene.time;
      time.scheme = Scheme::arkode;
      check_smooth(reader, scene);
      reader.refuse({"theta", "forecast gamma1", "forecast gamma2",
                     "cohesion rule", "contact target", "sliding",
                     "maximum bisections", "largest overshoot"},
                    "scheme = arkode has none");
      time.implicit_pairs =
          reader.choice("pairs", "explicit", {"explicit", "implicit"},
                        "of Runge-Kutta: explicit or implicit") == "implicit";
      // the pairs that ARKODE has
      time.order = time.implicit_pairs
                       ? reader.integer("order", "5", 2, 5, "2 to 5")
                       : reader.integer("order", "5", 2, 8, "2 to 6, or 8");
      if (time.order == 7)
        reader.error("order", "order = 7 is not among the explicit pairs",
                     "write 6 or 8");
      time.tolerance = reader.number(
          "integration tolerance", "1e-9", units::none, {0., 0.1, true, false},
          "error of a step relative to the largest motion");
    }

    /** Only one scheme iterates within a step; true if it is not this one. */
    bool refuse_scheme(SectionReader &reader, const SceneInput &scene,
                       const std::string &scheme)
    {
      if (!scene.iterates() || scheme == "moreau-jean")
        return false;
      reader.error("scheme",
                   fmt::format("scheme = {} is not available for {}", scheme,
                               scene.large_motion
                                   ? "motion = large"
                                   : history_dependent_model(scene)),
                   "write scheme = moreau-jean");
      reader.accept_everything();
      return true;
    }

    /** Of bodies: rates enter implicit steps and blocks of single cells. */
    void check_viscosity(SectionReader &reader, const SceneInput &scene,
                         const std::string &scheme)
    {
      if (!scene.has_viscous_bodies())
        return;
      if (scheme == "arkode")
        reader.error("scheme",
                     "scheme = arkode knows no viscosity, and a material has "
                     "one",
                     "write scheme = moreau-jean");
      if (scheme == "symplectic" && scene.has_bonded_faces())
        reader.error("scheme",
                     "scheme = symplectic takes bonded faces by explicit "
                     "forces, and viscous materials need implicit ones",
                     "write scheme = moreau-jean, or join the faces by the law "
                     "`rigid`");
    }

    template <typename T>
    T read_named(SectionReader &reader, const std::string &name,
                 const std::vector<std::pair<std::string, T>> &values,
                 const std::string &text)
    {
      std::vector<std::string> names;
      for (const auto &value : values)
        names.push_back(value.first);
      const std::string chosen =
          reader.choice(name, names.front(), names, text);
      for (const auto &value : values)
        if (value.first == chosen)
          return value.second;
      return values.front().second;
    }
  } // namespace

  void look_at_scheme(const ParameterFile &file, SceneInput &scene)
  {
    const ParameterSection *section = file.find("Time");
    const ParameterEntry *entry = section ? section->find("scheme") : nullptr;
    const std::string scheme = entry ? entry->value.text() : "";
    if (scheme == "explicit")
      scene.time.scheme = Scheme::leapfrog;
    else if (scheme == "symplectic")
      scene.time.scheme = Scheme::explicit_moreau_jean;
    else if (scheme == "arkode")
      scene.time.scheme = Scheme::arkode;
  }

  void read_time(ParameterFile &file, InputErrors &errors, SceneInput &scene)
  {
    SectionReader reader(file.open("Time"), errors);
    TimeInput &time = scene.time;
    time.end = reader.number("end", "", units::time, Range::positive(), "s");
    const std::string scheme = reader.choice(
        "scheme", "moreau-jean",
        {"moreau-jean", "explicit", "symplectic", "arkode", "quasi-static"},
        "moreau-jean, explicit, symplectic, arkode or "
        "quasi-static");
    if (refuse_scheme(reader, scene, scheme))
      return;
    check_viscosity(reader, scene, scheme);
    const bool quasi_static = scheme == "quasi-static";
    if (read_start(reader, scene, quasi_static)) {
      scene.statics.emplace();
      scene.statics->tolerance =
          reader.number("equilibrium tolerance", "1e-11", units::none,
                        {0., 1e-3, true, false},
                        "unbalanced force, relative to the forces present");
    } else
      reader.refuse({"equilibrium tolerance"},
                    "no equilibrium is computed in this scene");
    if (quasi_static && scene.statics)
      read_quasi_static(reader, scene);
    else {
      reader.refuse({"quasi-static until", "at solution jump", "dynamic step"},
                    "it belongs to scheme = quasi-static");
      read_step(reader, "step", time);
      check_step(reader, scene);
    }
    if (scheme == "arkode")
      return read_smooth(reader, scene);
    if (scheme == "explicit")
      return read_leapfrog(reader, scene);
    reader.refuse({"front viscosity"}, "it belongs to scheme = explicit");
    reader.refuse({"pairs", "order", "integration tolerance"},
                  "it belongs to scheme = arkode");
    if (scheme == "symplectic") {
      time.scheme = Scheme::explicit_moreau_jean;
      time.theta = 1.;
      reader.refuse({"theta"}, "scheme = symplectic has none");
    } else
      read_theta(reader, scene, time);
    time.forecast_gamma1 = reader.number(
        "forecast gamma1", "0.5", units::none, Range::closed(0., 1.),
        "weight of the old velocity in the forecast of the gap");
    time.forecast_gamma2 =
        reader.number("forecast gamma2", "0", units::none,
                      Range::closed(0., 1.), "weight of the new velocity");
    if (time.forecast_gamma2 != 0. && !scene.large_motion)
      reader.error("forecast gamma2",
                   "an implicit forecast of the gap needs motion = large",
                   "write: forecast gamma2 = 0");
    time.cohesion_rule =
        read_named<CohesionRule>(reader, "cohesion rule",
                                 {{"exact", CohesionRule::exact},
                                  {"end point", CohesionRule::end_point},
                                  {"end velocity", CohesionRule::end_velocity}},
                                 "exact, end point or end velocity");
    time.contact_target =
        read_named<ContactTarget>(reader, "contact target",
                                  {{"energy safe", ContactTarget::energy_safe},
                                   {"velocity", ContactTarget::velocity},
                                   {"position", ContactTarget::position}},
                                  "energy safe, velocity or position");
    time.sliding = read_named<Sliding>(
        reader, "sliding",
        {{"energy safe", Sliding::energy_safe},
         {"velocity", Sliding::velocity},
         {"increment", Sliding::increment}},
        "the velocity that friction opposes: that of the end of the step "
        "(velocity), the mean (increment), or that of the end but for points "
        "where friction would then give energy (energy safe)");
    time.maximum_bisections = reader.integer("maximum bisections", "10", 0, 60,
                                             "of a step that is rejected");
    read_overshoot(reader, scene);
  }
} // namespace nsfd
