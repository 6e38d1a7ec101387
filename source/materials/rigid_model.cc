#include "nsfd/materials/material_entries.h"
#include "parameters/input_errors.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

namespace nsfd
{
  namespace
  {
    /** What bodies are, and where their surface is. */
    void read_extent(SectionReader &reader, RigidInput &rigid)
    {
      const unsigned int n_before = reader.errors().n_errors();
      rigid.connected =
          reader.choice("bodies", "cells", {"cells", "connected"},
                        "each of the cells, or connected: cells that touch "
                        "are one body") == "connected";
      rigid.ball = reader.choice("surface", "mesh", {"mesh", "ball"},
                                 "that of the mesh, or the ball (disc) around "
                                 "a connected body's centre out to its "
                                 "farthest corner") == "ball";
      if (rigid.ball && !rigid.connected &&
          reader.errors().n_errors() == n_before)
        reader.error("surface",
                     "surface = ball is for bodies of several cells, and "
                     "every cell is a body here",
                     "add: set bodies = connected");
    }

    /** No distribution of mass has a moment above the sum of the others. */
    void check_inertia(SectionReader &reader, const std::string &name,
                       const std::array<double, 3> &inertia)
    {
      constexpr double round_off = 1e-12;
      for (unsigned int c = 0; c < 3; ++c) {
        const double others = inertia[(c + 1) % 3] + inertia[(c + 2) % 3];
        if (inertia[c] > others * (1. + round_off))
          return reader.error(
              name,
              fmt::format("{}: {:g} about {} is above {:g}, the sum of the "
                          "two others: no body is like that",
                          name, inertia[c], "xyz"[c], others),
              fmt::format("write at most {:g}", others));
      }
    }

    void read_mass(SectionReader &reader, const unsigned int dim,
                   RigidInput &rigid)
    {
      const std::string mass = "mass", inertia = "principal inertia";
      const std::string mass_text =
          dim == 2 ? "kg/m, of each body; default: that of its cells"
                   : "kg, of each body; default: that of its cells";
      if (reader.optional(mass, mass_text))
        rigid.mass = reader.number(
            mass, "", dim == 2 ? units::mass_per_length : units::mass,
            Range::positive(), mass_text);
      const std::string inertia_text =
          dim == 2 ? "kg m^2/m about z, of each body; default: that of its "
                     "cells"
                   : "kg m^2 about x, y, z through the centre of mass, of each "
                     "body; default: that of its cells";
      if (!reader.optional(inertia, inertia_text))
        return;
      const unsigned int n_before = reader.errors().n_errors();
      const std::vector<double> moments = reader.numbers(
          inertia, "", dim == 2 ? units::inertia_per_length : units::inertia,
          Range::positive(), dim == 2 ? 1 : 3, inertia_text);
      if (dim == 2)
        rigid.inertia = {0., 0., moments[0]};
      else {
        rigid.inertia = {moments[0], moments[1], moments[2]};
        if (reader.errors().n_errors() == n_before)
          check_inertia(reader, inertia, *rigid.inertia);
      }
    }
  } // namespace

  /** Bodies that do not deform; with large motions of any extent and mass. */
  class Rigid final : public MaterialModel
  {
  public:
    MaterialKind kind() const override { return MaterialKind::rigid; }
    unsigned int place() const override { return 2; }

    void read(SectionReader &reader, const MaterialSetting &setting,
              MaterialInput &material) override
    {
      using namespace materials;
      const std::string reason = "the material is rigid";
      refuse_axis(reader);
      refuse_isotropic(reader, reason);
      read_density(reader, why_uniform(setting), material);
      refuse_viscosity(reader, reason);
      refuse_flow(reader);
      if (!setting.large_motion)
        return refuse_rigid_bodies(
            reader, "it needs motion = large; with motion = small a rigid body "
                    "has the mass of its cells: each of them is one, with "
                    "scheme = explicit all that are joined");
      read_extent(reader, material.rigid_bodies);
      read_mass(reader, setting.dimension, material.rigid_bodies);
    }
  };

  NSFD_REGISTER(MaterialRegistry, Rigid, "rigid", "bodies do not deform",
                "density = 1000 kg/m^3");
} // namespace nsfd
