#include "nsfd/materials/material_entries.h"
#include "parameters/input_errors.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    const std::vector<std::string> transverse_names = {
        "axis",
        "axial Young modulus",
        "transverse Young modulus",
        "axial Poisson ratio",
        "transverse Poisson ratio",
        "axial shear modulus"};

    /** Of length 1; in plane problems in the plane or normal to it. */
    std::array<double, 3> read_axis(SectionReader &reader,
                                    const MaterialSetting &setting)
    {
      const unsigned int n_before = reader.errors().n_errors();
      const auto given = reader.numbers(
          transverse_names[0], "1, 0, 0", units::none, Range::any(), 3,
          "direction of the axis of symmetry, of any length");
      std::array<double, 3> axis{{given[0], given[1], given[2]}};
      const double size = std::hypot(axis[0], axis[1], axis[2]);
      const bool known = reader.errors().n_errors() == n_before;
      if (known && size == 0.)
        reader.error(transverse_names[0], "the axis has no direction",
                     "write for example: set axis = 1, 0, 0");
      for (double &component : axis)
        component /= size > 0. ? size : 1.;
      if (setting.dimension == 3 || axis[2] == 0.)
        return axis;
      if (known && size > 0. && (axis[0] != 0. || axis[1] != 0.))
        reader.error(transverse_names[0],
                     "an axis that is neither in the plane nor normal to it "
                     "makes bodies move out of the plane",
                     fmt::format("write set axis = {:g}, {:g}, 0 or set axis = "
                                 "0, 0, 1, or take dimension = 3",
                                 given[0], given[1]));
      return {{0., 0., 1.}};
    }

    /** Hooke's matrix is positive definite. */
    void check_transverse(SectionReader &reader, const TransverseInput &input)
    {
      const double ratio = input.axial_young / input.transverse_young,
                   bound =
                       std::sqrt((1. - input.transverse_poisson) * ratio / 2.);
      if (std::abs(input.axial_poisson) < bound)
        return;
      reader.error(
          transverse_names[3],
          fmt::format("axial Poisson ratio = {:g} makes a state of strain with "
                      "negative energy: its square must be below (1 - "
                      "transverse Poisson ratio) (axial over transverse Young "
                      "modulus) / 2",
                      input.axial_poisson),
          fmt::format("write a number above {:.4g} and below {:.4g}; it is the "
                      "contraction across over the extension along the axis",
                      -bound, bound));
    }

    TransverseInput read_transverse(SectionReader &reader,
                                    const MaterialSetting &setting)
    {
      const unsigned int n_before = reader.errors().n_errors();
      TransverseInput input;
      input.axis = read_axis(reader, setting);
      const auto modulus = [&](const unsigned int k, const char *text) {
        return reader.number(transverse_names[k], "", units::pressure,
                             Range::positive(), text);
      };
      input.axial_young = modulus(1, "Pa, along the axis");
      input.transverse_young = modulus(2, "Pa, across the axis");
      input.axial_poisson =
          reader.number(transverse_names[3], "", units::none, Range::any(),
                        "contraction across over extension along the axis");
      input.transverse_poisson = reader.number(
          transverse_names[4], "", units::none, {-1., 1., true, true},
          "contraction over extension, both across the axis");
      input.axial_shear =
          modulus(5, "Pa, of shear between the axis and any direction across");
      if (reader.errors().n_errors() == n_before)
        check_transverse(reader, input);
      return input;
    }
  } // namespace

  /** Hooke's law. */
  class LinearElastic final : public MaterialModel
  {
  public:
    MaterialKind kind() const override { return MaterialKind::small_strain; }
    unsigned int place() const override { return 0; }

    void read(SectionReader &reader, const MaterialSetting &setting,
              MaterialInput &material) override
    {
      using namespace materials;
      demand_small_motion(reader, setting, material);
      refuse_axis(reader);
      read_isotropic(reader, why_uniform(setting), material);
      read_viscosity(reader, setting, material);
      refuse_flow(reader);
      refuse_rigid_bodies(reader, "the material is not rigid");
    }
  };

  /** Hooke's law with five constants, the same in all directions across an
   * axis. */
  class TransverselyIsotropic final : public MaterialModel
  {
  public:
    MaterialKind kind() const override { return MaterialKind::small_strain; }
    unsigned int place() const override { return 1; }

    void read(SectionReader &reader, const MaterialSetting &setting,
              MaterialInput &material) override
    {
      using namespace materials;
      demand_small_motion(reader, setting, material);
      material.transverse = read_transverse(reader, setting);
      refuse_cubic(reader);
      refuse_orthotropic(reader);
      refuse_orientation(reader);
      refuse_isotropic(reader, "the material is transversely isotropic and "
                               "has an axial and a transverse one");
      read_density(reader, why_uniform(setting), material);
      material.young = material.poisson =
          std::numeric_limits<double>::quiet_NaN();
      read_viscosity(reader, setting, material);
      refuse_flow(reader);
      refuse_rigid_bodies(reader, "the material is not rigid");
    }
  };

  NSFD_REGISTER(
      MaterialRegistry, LinearElastic, "linear elastic",
      "Hooke's law; motion = small",
      "Young modulus = 2 GPa; Poisson ratio = 0.3; density = 1000 kg/m^3");
  NSFD_REGISTER(
      MaterialRegistry, TransverselyIsotropic, "transversely isotropic",
      "Hooke's law about an axis: fibres, layers, wood; motion = small",
      "axial Young modulus = 10 GPa; transverse Young modulus = 1 GPa; axial "
      "Poisson ratio = 0.3; transverse Poisson ratio = 0.4; axial shear "
      "modulus = 0.6 GPa; density = 500 kg/m^3");
} // namespace nsfd
