#include "linear_moreau_jean.h"
#include "smooth_motion.h"
#include "time_scheme.h"

#include "nsfd/parameters/section_reader.h"

#include <fmt/format.h>

namespace nsfd
{
  namespace
  {
    /** Nothing may open, close or slip. */
    void check_smooth(SectionReader &reader, const SceneInput &scene)
    {
      for (const InterfaceInput &interface : scene.interfaces) {
        if (interface.obstacle >= 0)
          continue; // the obstacle is named below
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

    template <int dim>
    void make_smooth(const IntegratorParts<dim> &parts,
                     Integrators<dim> &integrators)
    {
      integrators.stepper = std::make_unique<LinearMoreauJean<dim>>(
          parts.input, parts.discretization, *parts.delassus, *parts.solver,
          parts.bonded);
      integrators.other = std::make_unique<SmoothMotion<dim>>(
          parts.input, parts.discretization, *parts.delassus, parts.bonded);
    }
  } // namespace

  /** Runge-Kutta pairs of SUNDIALS for scenes without events. */
  class ArkodeScheme final : public TimeScheme
  {
  public:
    unsigned int place() const override { return 3; }

    SchemeTraits traits() const override
    {
      SchemeTraits traits;
      traits.theta_scheme = false;
      traits.smooth = true;
      return traits;
    }

    std::string solver() const override { return "arkode"; }

    std::vector<std::string> entries() const override
    {
      return {"pairs", "order", "integration tolerance"};
    }

    void demand(SectionReader &reader, const SceneInput &scene) const override
    {
      if (scene.has_viscous_bodies())
        reader.error("scheme",
                     "scheme = arkode knows no viscosity, and a material has "
                     "one",
                     "write scheme = moreau-jean");
    }

    void read(SectionReader &reader, SceneInput &scene) const override
    {
      if (scene.has_initial_stress())
        reader.error("scheme",
                     "scheme = arkode knows no initial stress, and the scene "
                     "has one",
                     "write scheme = moreau-jean");
      if (scene.has_absorbing_sides())
        reader.error("scheme",
                     "scheme = arkode knows no absorbing sides, and the scene "
                     "has one",
                     "write scheme = moreau-jean");
      check_smooth(reader, scene);
      SmoothInput &smooth = scene.time.smooth;
      smooth.implicit =
          reader.choice("pairs", "explicit", {"explicit", "implicit"},
                        "of Runge-Kutta: explicit or implicit") == "implicit";
      // the pairs that ARKODE has
      smooth.order = smooth.implicit
                         ? reader.integer("order", "5", 2, 5, "2 to 5")
                         : reader.integer("order", "5", 2, 8, "2 to 6, or 8");
      if (smooth.order == 7)
        reader.error("order", "order = 7 is not among the explicit pairs",
                     "write 6 or 8");
      smooth.tolerance = reader.number(
          "integration tolerance", "1e-9", units::none, {0., 0.1, true, false},
          "error of a step relative to the largest motion, and of the energy "
          "balance");
    }

  private:
    void make(const IntegratorParts<2> &parts,
              Integrators<2> &integrators) const override
    {
      make_smooth(parts, integrators);
    }
    void make(const IntegratorParts<3> &parts,
              Integrators<3> &integrators) const override
    {
      make_smooth(parts, integrators);
    }
  };

  NSFD_REGISTER(TimeSchemeRegistry, ArkodeScheme, "arkode",
                "motion in which nothing opens, closes or slips: Runge-Kutta "
                "pairs of SUNDIALS, motion = small",
                "pairs = implicit; order = 4; integration tolerance = 1e-7",
                "pairs = explicit; order = 8; integration tolerance = 1e-7");
} // namespace nsfd
