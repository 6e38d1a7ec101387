#include "linear_moreau_jean.h"
#include "newton_moreau_jean.h"
#include "step_entry.h"
#include "step_rule.h"
#include "time_scheme.h"

#include "nsfd/parameters/section_reader.h"
#include "parameters/input_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace nsfd
{
  namespace
  {
    void read_theta(SectionReader &reader, SceneInput &scene)
    {
      TimeInput &time = scene.time;
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
    /** How contact, friction, cohesion and bisections are done in a step. */
    void read_rules(SectionReader &reader, SceneInput &scene)
    {
      TimeInput &time = scene.time;
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
      time.cohesion_rule = read_named<CohesionRule>(
          reader, "cohesion rule",
          {{"exact", CohesionRule::exact},
           {"end point", CohesionRule::end_point},
           {"end velocity", CohesionRule::end_velocity}},
          "exact, end point or end velocity");
      time.contact_target = read_named<ContactTarget>(
          reader, "contact target",
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
      time.maximum_bisections =
          reader.integer("maximum bisections", "10", 0, 60,
                         "of a step that is rejected; a solution jump that "
                         "relaxes is found to "
                         "a 32nd of the load step unless they are given");
      for (const auto &rule : all_step_rules())
        rule->read(reader, scene);
    }

    template <int dim>
    void make_stepper(const IntegratorParts<dim> &parts,
                      Integrators<dim> &integrators)
    {
      if (parts.moving)
        integrators.stepper = std::make_unique<NewtonMoreauJean<dim>>(
            parts.input, parts.discretization, *parts.moving, *parts.delassus);
      else if (parts.inelastic)
        integrators.stepper = std::make_unique<NewtonMoreauJean<dim>>(
            parts.input, parts.discretization, *parts.inelastic,
            *parts.delassus);
      else
        integrators.stepper = std::make_unique<LinearMoreauJean<dim>>(
            parts.input, parts.discretization, *parts.delassus, *parts.solver,
            parts.bonded);
    }
  } // namespace

  /** Section 6 of doc/theory.md. */
  class MoreauJeanScheme : public TimeScheme
  {
  public:
    unsigned int place() const override { return 0; }
    SchemeTraits traits() const override { return {}; }
    bool takes_nonlinear_bodies() const override { return true; }

    std::vector<std::string> entries() const override
    {
      return {"theta",
              "forecast gamma1",
              "forecast gamma2",
              "cohesion rule",
              "contact target",
              "sliding",
              "maximum bisections",
              "largest overshoot"};
    }

    void read(SectionReader &reader, SceneInput &scene) const override
    {
      read_theta(reader, scene);
      read_rules(reader, scene);
    }

  private:
    void make(const IntegratorParts<2> &parts,
              Integrators<2> &integrators) const override
    {
      make_stepper(parts, integrators);
    }
    void make(const IntegratorParts<3> &parts,
              Integrators<3> &integrators) const override
    {
      make_stepper(parts, integrators);
    }
  };

  /** The same with theta = 1/2 around explicit forces of the bodies. */
  class SymplecticScheme final : public MoreauJeanScheme
  {
  public:
    unsigned int place() const override { return 2; }
    bool takes_nonlinear_bodies() const override { return false; }

    SchemeTraits traits() const override
    {
      SchemeTraits traits;
      traits.theta_scheme = false;
      traits.explicit_forces = true;
      return traits;
    }

    std::vector<std::string> entries() const override
    {
      auto entries = MoreauJeanScheme::entries();
      entries.erase(std::find(entries.begin(), entries.end(), "theta"));
      return entries;
    }

    void read(SectionReader &reader, SceneInput &scene) const override
    {
      scene.time.theta = 0.5;
      read_rules(reader, scene);
    }
  };

  namespace
  {
    /** What a path of equilibria through limit points does not know. */
    void refuse_path(SectionReader &reader, const SceneInput &scene)
    {
      const std::string entry = "at solution jump",
                        other = "write relax, stop or dynamic here";
      const auto refuse = [&](const std::string &what,
                              const std::string &cure) {
        reader.error(entry, "arc length does not follow " + what, cure);
      };
      for (const InterfaceInput &block : scene.interfaces) {
        const std::string of = " of `" + block.section() + "`";
        if (block.friction > 0.)
          refuse("friction" + of, "set friction = 0 there, or " + other);
        if (block.law && block.law->extrinsic() && scene.dimension == 3)
          refuse("extrinsic laws in space" + of,
                 "write an intrinsic law there, or " + other);
        if (block.plateau || (block.law && block.law->adds_openings()))
          refuse("tractions that stay while a point closes" + of,
                 "write another law there, or " + other);
        if (block.law &&
            (block.law->mixed() || block.law->rate_dependent() ||
             block.law->heals() || std::isinf(block.law->steepest_softening())))
          refuse("a law that takes time, drops at once or has two damage "
                 "scalars" +
                     of,
                 "write another law there, or " + other);
      }
      for (const BoundaryInput &boundary : scene.boundaries)
        if (boundary.hold_at != CrackEvent::none)
          refuse("loads that stop at an event, those of `Boundary: " +
                     boundary.name + "`",
                 "set hold at = never there, or " + other);
      for (const ObstacleInput &obstacle : scene.obstacles)
        if (obstacle.friction > 0.)
          refuse("friction of `Obstacle: " + obstacle.name + "`",
                 "set friction = 0 there, or " + other);
      if (scene.has_rigid_bodies())
        refuse("rigid bodies", "let them deform, or " + other);
      if (scene.has_heat())
        refuse("heat", "leave `heat capacity` out, or " + other);
      if (!scene.equilibria_at_nodes)
        refuse("cells that share no nodes",
               "leave `method` and `path` of section Solver and section "
               "Adaptivity out, or " +
                   other);
      if (reader.has("quasi-static until"))
        refuse("what comes after `quasi-static until`: the load time may be "
               "another one then",
               "leave that entry out, or " + other);
    }
  } // namespace

  /** Equilibria from one load to the next, and Moreau-Jean steps after them. */
  class QuasiStaticScheme final : public MoreauJeanScheme
  {
  public:
    unsigned int place() const override { return 4; }
    bool takes_nonlinear_bodies() const override { return false; }
    bool is_static() const override { return true; }

    std::vector<std::string> entries() const override
    {
      auto entries = MoreauJeanScheme::entries();
      for (const char *const entry :
           {"quasi-static until", "at solution jump", "dynamic step"})
        entries.push_back(entry);
      return entries;
    }

    void read_steps(SectionReader &reader, SceneInput &scene) const override
    {
      if (!scene.statics) { // reported: what its steps are is unknown
        reader.accept_everything();
        return;
      }
      TimeInput &time = scene.time;
      StaticInput &statics = *scene.statics;
      statics.steps = true;
      statics.step = read_load_step(reader);
      statics.until = time.end;
      if (reader.optional("quasi-static until",
                          "s; Moreau-Jean steps after it"))
        statics.until = reader.number("quasi-static until", "", units::time,
                                      {0., time.end, true, false},
                                      "s; Moreau-Jean steps after it");
      const std::string at_jump = reader.choice(
          "at solution jump", "relax",
          {"relax", "stop", "dynamic", "arc length"},
          "where no equilibrium continues the last: take the next one that "
          "energy suffices for (relax), stop, follow it in time (dynamic), or "
          "follow the equilibria while the loads run backwards (arc length)");
      statics.at_jump = at_jump == "dynamic"      ? SolutionJump::dynamic
                        : at_jump == "relax"      ? SolutionJump::relax
                        : at_jump == "arc length" ? SolutionJump::arc_length
                                                  : SolutionJump::stop;
      if (statics.at_jump == SolutionJump::arc_length)
        refuse_path(reader, scene);
      if (reader.has("maximum bisections"))
        statics.jump_bisections = std::numeric_limits<unsigned int>::max();
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
  };

  NSFD_REGISTER(TimeSchemeRegistry, MoreauJeanScheme, "moreau-jean",
                "implicit: theta scheme of the bodies, impulses of contact, "
                "friction and cohesion in one problem per step",
                "theta = 1; cohesion rule = end point; contact target = "
                "velocity; sliding = velocity; forecast gamma1 = 0; forecast "
                "gamma2 = 0; maximum bisections = 3");
  NSFD_REGISTER(
      TimeSchemeRegistry, SymplecticScheme, "symplectic",
      "the same with explicit forces of the bodies: stable up to a "
      "step of its cells; motion = small",
      "cohesion rule = end point; contact target = velocity; sliding "
      "= increment; forecast gamma1 = 0; forecast gamma2 = 0; maximum "
      "bisections = 3");
  NSFD_REGISTER(
      TimeSchemeRegistry, QuasiStaticScheme, "quasi-static",
      "equilibria from one load to the next, then moreau-jean; "
      "motion = small",
      "quasi-static until = 0.5; at solution jump = dynamic; dynamic "
      "step = 0.3 courant; theta = 1; cohesion rule = end point; "
      "contact target = velocity; sliding = velocity; forecast gamma1 "
      "= 0; forecast gamma2 = 0; maximum bisections = 3");
} // namespace nsfd
