#include "nsfd/materials/material_entries.h"

#include "nsfd/parameters/initial_expression.h"
#include "parameters/input_errors.h"
#include "parameters/parameter_file.h"
#include "parameters/quantity.h"

#include <fmt/format.h>

#include <cctype>
#include <limits>
#include <vector>

namespace nsfd::materials
{
  namespace
  {
    const std::vector<std::string> isotropic_names = {"Young modulus",
                                                      "Poisson ratio"},
                                   viscosity_names = {"shear viscosity",
                                                      "bulk viscosity"};

    /** A coordinate occurs, or the time, which is refused. */
    bool depends(const std::string &text)
    {
      std::string word;
      for (const char c : text + " ")
        if (std::isalnum(static_cast<unsigned char>(c)) || c == '_')
          word += c;
        else {
          if (word == "x" || word == "y" || word == "z" || word == "t")
            return true;
          word.clear();
        }
      return false;
    }

    /** Data of the cells of a mesh are functions of the place, too. */
    bool names_cell_data(SectionReader &reader, const SourceText &text,
                         const Unit unit)
    {
      const InputErrors before = reader.errors();
      const Expression value = reader.expression_in(text, "", unit);
      reader.errors() = before; // whoever reads it in the end reports
      return value.depends_on_position();
    }

    /** In @p range; an expression, checked in the cells, unless @p uniform. */
    Expression read_constant(SectionReader &reader, const std::string &uniform,
                             const std::string &name, const Unit unit,
                             const Range range, const std::string &text)
    {
      if (!reader.has(name))
        return reader.number(name, "", unit, range, text);
      const auto given = reader.raw(name, "", text, example(unit));
      if (!given)
        return Expression(std::numeric_limits<double>::quiet_NaN());
      if (!depends(given->text()) && !names_cell_data(reader, *given, unit))
        return reader.number_in(*given, name, "", unit, range);
      const unsigned int n_before = reader.errors().n_errors();
      Expression value = read_initial_expression(reader, name, "", unit, text);
      if (!uniform.empty() && reader.errors().n_errors() == n_before)
        reader.error(
            name,
            fmt::format("{} = {} depends on the place, and {}", name,
                        value.text(), uniform),
            "write a number; blocks with their own `where` may differ");
      return value;
    }

    double constant_of(const Expression &value)
    {
      return value.is_constant() ? value(0., 0., 0.)
                                 : std::numeric_limits<double>::quiet_NaN();
    }

    /** What is there as numbers, and as expressions if one of them needs it. */
    void set_constants(const GradedInput &constants, MaterialInput &material)
    {
      material.young = constant_of(constants.young);
      material.poisson = constant_of(constants.poisson);
      material.density = constant_of(constants.density);
      if (!constants.young.is_constant() || !constants.poisson.is_constant() ||
          !constants.density.is_constant())
        material.graded = constants;
    }

    std::string place_text(const std::string &uniform)
    {
      return uniform.empty() ? ", may depend on x, y, z" : "";
    }

    Expression density_of(SectionReader &reader, const std::string &uniform)
    {
      return read_constant(reader, uniform, "density", units::density,
                           Range::positive(), "kg/m^3" + place_text(uniform));
    }
  } // namespace

  std::string why_uniform(const MaterialSetting &setting)
  {
    return setting.large_motion ? "the scene has motion = large" : "";
  }

  void read_isotropic(SectionReader &reader, const std::string &uniform,
                      MaterialInput &material)
  {
    GradedInput constants;
    constants.young =
        read_constant(reader, uniform, isotropic_names[0], units::pressure,
                      Range::positive(), "Pa" + place_text(uniform));
    // the bulk modulus is infinite at 1/2, the shear modulus at -1
    constants.poisson =
        read_constant(reader, uniform, isotropic_names[1], units::none,
                      {-1., 0.5, true, true},
                      "lateral over axial strain" + place_text(uniform));
    constants.density = density_of(reader, uniform);
    set_constants(constants, material);
  }

  void read_density(SectionReader &reader, const std::string &uniform,
                    MaterialInput &material)
  {
    GradedInput constants;
    constants.density = density_of(reader, uniform);
    set_constants(constants, material);
  }

  void read_viscosity(SectionReader &reader, const MaterialSetting &setting,
                      MaterialInput &material)
  {
    if (setting.large_motion)
      return refuse_viscosity(reader, "it needs motion = small");
    material.shear_viscosity = reader.number(
        viscosity_names[0], "0", units::viscosity, Range::non_negative(),
        "Pa s, eta of the Kelvin-Voigt stress 2 eta dev(rate) + zeta "
        "tr(rate)");
    material.bulk_viscosity =
        reader.number(viscosity_names[1], "0", units::viscosity,
                      Range::non_negative(), "Pa s, zeta of it");
    if (material.is_viscous() && setting.dimension == 2 && setting.plane_stress)
      reader.error(material.shear_viscosity > 0. ? viscosity_names[0]
                                                 : viscosity_names[1],
                   "viscosity is not available for plane = stress, where the "
                   "strain normal to the plane has a history of its own",
                   "write plane = strain, or leave it out");
  }

  void demand_small_motion(SectionReader &reader,
                           const MaterialSetting &setting,
                           const MaterialInput &material)
  {
    if (setting.large_motion)
      reader.error("model",
                   fmt::format("model = {} is for bodies that turn and strain "
                               "little, and the scene has motion = large",
                               material.model_name),
                   "write model = saint-venant kirchhoff or neo-hookean");
  }

  void demand_large_motion(SectionReader &reader,
                           const MaterialSetting &setting,
                           const MaterialInput &material)
  {
    if (!setting.large_motion)
      reader.error("model",
                   fmt::format("model = {} is for large strains, and the scene "
                               "has motion = small",
                               material.model_name),
                   "write at the top: set motion = large");
  }

  void refuse_isotropic(SectionReader &reader, const std::string &reason)
  {
    reader.refuse(isotropic_names, reason);
  }

  void refuse_axis(SectionReader &reader)
  {
    refuse_transverse(reader);
    refuse_cubic(reader);
    refuse_orthotropic(reader);
    refuse_orientation(reader);
  }

  void refuse_cubic(SectionReader &reader)
  {
    reader.refuse({"C11", "C12", "C44", "shear modulus"},
                  "it needs model = cubic");
  }

  void refuse_orthotropic(SectionReader &reader)
  {
    reader.refuse(
        {"E1", "E2", "E3", "nu12", "nu13", "nu23", "G12", "G13", "G23"},
        "it needs model = orthotropic");
  }

  void refuse_orientation(SectionReader &reader)
  {
    reader.refuse({"orientation", "Euler angles", "axis 1", "axis 2",
                   "orientation seed", "orientation file", "orientation data"},
                  "it needs model = cubic or orthotropic");
  }

  void refuse_transverse(SectionReader &reader)
  {
    reader.refuse({"axis", "axial Young modulus", "transverse Young modulus",
                   "axial Poisson ratio", "transverse Poisson ratio",
                   "axial shear modulus"},
                  "it needs model = transversely isotropic");
  }

  void refuse_viscosity(SectionReader &reader, const std::string &reason)
  {
    reader.refuse(viscosity_names, reason);
  }

  void refuse_flow(SectionReader &reader)
  {
    reader.refuse({"yield stress", "isotropic hardening modulus",
                   "kinematic hardening modulus", "saturation stress",
                   "saturation exponent", "viscosity", "rate exponent",
                   "reference rate"},
                  "the material does not flow");
  }

  void refuse_rigid_bodies(SectionReader &reader, const std::string &reason)
  {
    reader.refuse({"bodies", "surface", "mass", "principal inertia"}, reason);
  }
} // namespace nsfd::materials
