#include "leapfrog.h"
#include "step_entry.h"
#include "time_scheme.h"

#include "nsfd/parameters/section_reader.h"
#include "parameters/parameter_file.h"

#include <fmt/format.h>

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

    /** What an equilibrium of joined cells does not know yet. */
    void refuse_start(SectionReader &reader, const SceneInput &scene)
    {
      const auto refuse = [&reader](const std::string &what) {
        reader.error("start",
                     "the equilibrium that scheme = explicit starts from has "
                     "no " +
                         what,
                     "write given, or scheme = moreau-jean");
      };
      for (const MaterialInput &material : scene.materials)
        if (material.rigid)
          refuse(fmt::format("rigid bodies yet, and material `{}` is rigid",
                             material.name));
      for (const ObstacleInput &obstacle : scene.obstacles)
        if (obstacle.cohesion >= 0)
          refuse(fmt::format("cohesion on obstacles yet, and bodies stick to "
                             "Obstacle: {}",
                             obstacle.name));
      for (const InterfaceInput &block : scene.interfaces)
        if (block.law && !block.law->extrinsic() &&
            block.law->elastic_limit() == 0.)
          refuse(fmt::format("law without a straight part, and {} of {} is one",
                             block.law_name, block.section()));
    }

    /** What explicit steps of large motions do not know yet. */
    void refuse_large(SectionReader &reader, const SceneInput &scene)
    {
      const auto refuse = [&reader](const std::string &what) {
        reader.error("scheme",
                     "scheme = explicit with motion = large has no " + what,
                     "write scheme = moreau-jean");
      };
      for (const InterfaceInput &block : scene.interfaces)
        if (block.crack_pressure)
          refuse(fmt::format("pressure in cracks yet, and `{}` has one",
                             block.name));
      for (const ContactInput &contact : scene.contacts)
        refuse_lift(reader, contact);
    }

    template <int dim>
    void make_leapfrog(const IntegratorParts<dim> &parts,
                       Integrators<dim> &integrators)
    {
      integrators.other = std::make_unique<Leapfrog<dim>>(
          parts.input, parts.discretization, parts.communicator,
          parts.ghost_layer());
    }
  } // namespace

  /** Section 12 of doc/theory.md, on joined cells. */
  class ExplicitScheme final : public TimeScheme
  {
  public:
    unsigned int place() const override { return 1; }

    SchemeTraits traits() const override
    {
      SchemeTraits traits;
      traits.theta_scheme = false;
      traits.at_nodes = true;
      return traits;
    }

    bool takes_nonlinear_bodies() const override { return true; }

    std::string solver() const override { return "node by node"; }

    std::vector<std::string> entries() const override
    {
      return {"front viscosity"};
    }

    void read_steps(SectionReader &reader, SceneInput &scene) const override
    {
      // cells of a mesh differ: a Courant number of the smallest one is either
      // beyond the stable step or far below it
      read_step(reader, "step", scene.time, "auto");
      check_step(reader, scene);
    }

    void read(SectionReader &reader, SceneInput &scene) const override
    {
      // steps of linear bodies have one length, see Leapfrog
      scene.time.maximum_bisections = scene.iterates() ? 8 : 0;
      if (scene.large_motion) {
        scene.time.forecast_gamma2 = 1.; // all that is near may touch
        refuse_large(reader, scene);
      }
      const auto front = reader.raw(
          "front viscosity", "auto",
          "share of critical damping where the rate of strain jumps between "
          "cells: auto (0.2 if a face can break, else 0) or a number",
          "auto");
      if (front && front->text() != "auto")
        scene.time.front_viscosity =
            reader.number_in(*front, "front viscosity", "0.2", units::none,
                             Range::closed(0., 1.));
      for (InterfaceInput &interface : scene.interfaces) {
        refuse_lift(reader, interface);
        // what holds two cells together are their common nodes
        if (interface.intact == IntactFaces::rigid && interface.obstacle < 0)
          interface.intact = IntactFaces::bonded;
      }
      for (const ObstacleInput &obstacle : scene.obstacles)
        refuse_lift(reader, obstacle);
      if (scene.statics)
        refuse_start(reader, scene);
    }

  private:
    void make(const IntegratorParts<2> &parts,
              Integrators<2> &integrators) const override
    {
      make_leapfrog(parts, integrators);
    }
    void make(const IntegratorParts<3> &parts,
              Integrators<3> &integrators) const override
    {
      make_leapfrog(parts, integrators);
    }
  };

  NSFD_REGISTER(TimeSchemeRegistry, ExplicitScheme, "explicit",
                "explicit steps of joined cells with lumped mass, impulses in "
                "one problem per node",
                "front viscosity = 0.1");
} // namespace nsfd
