#include "read_sections.h"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <limits>

namespace nsfd
{
  std::string component_name(const std::string &name,
                             const unsigned int component)
  {
    return name + " " + "xyz"[component];
  }

  void refuse_third_component(SectionReader &reader,
                              const std::vector<std::string> &names,
                              const SceneInput &scene)
  {
    if (scene.dimension == 3)
      return;
    for (const std::string &name : names)
      reader.refuse({component_name(name, 2)}, "dimension = 2 has no z");
  }

  namespace
  {
    struct KnownModel {
      BulkModel model;
      NamedText written;
    };

    const KnownModel known_models[] = {
        {BulkModel::linear_elastic,
         {"linear elastic", "Hooke's law; motion = small"}},
        {BulkModel::transversely_isotropic,
         {"transversely isotropic",
          "Hooke's law about an axis: fibres, layers, wood; motion = small"}},
        {BulkModel::rigid, {"rigid", "bodies do not deform"}},
        {BulkModel::saint_venant_kirchhoff,
         {"saint-venant kirchhoff",
          "Hooke's law between the Green strain and its stress; large "
          "rotations, moderate strains; motion = large"}},
        {BulkModel::neo_hookean,
         {"neo-hookean",
          "compressible, resists being crushed; motion = large"}},
        {BulkModel::j2_plastic,
         {"j2 plastic", "flow on the surface of von Mises, which grows and "
                        "moves; small or large motion"}},
        {BulkModel::viscoplastic,
         {"viscoplastic",
          "the same, and beyond the surface by an overstress that grows with "
          "the rate; small or large motion"}},
    };

    bool flows(const BulkModel model)
    {
      return model == BulkModel::j2_plastic || model == BulkModel::viscoplastic;
    }

    void check_model(SectionReader &reader, const SceneInput &scene,
                     const BulkModel model)
    {
      const char *const name = model_name(model);
      if (scene.large_motion && (model == BulkModel::linear_elastic ||
                                 model == BulkModel::transversely_isotropic))
        reader.error("model",
                     fmt::format("model = {} is for bodies that turn and "
                                 "strain little, and the scene has motion = "
                                 "large",
                                 name),
                     "write model = saint-venant kirchhoff or neo-hookean");
      if (!scene.large_motion && is_finite_strain(model))
        reader.error("model",
                     fmt::format("model = {} is for large strains, and the "
                                 "scene has motion = small",
                                 name),
                     "write at the top: set motion = large");
      if (scene.plane_stress && model == BulkModel::neo_hookean)
        reader.error(
            "model",
            fmt::format("model = {} is not available for plane = stress", name),
            "write plane = strain, or model = saint-venant "
            "kirchhoff");
      if (scene.plane_stress && scene.large_motion && flows(model))
        reader.error(
            "model",
            fmt::format("model = {} is not available for plane = stress "
                        "with motion = large",
                        name),
            "write plane = strain, or motion = small");
    }

    /** False if it is none: what the other entries mean is unknown. */
    bool read_model(SectionReader &reader, const SceneInput &scene,
                    MaterialInput &material)
    {
      std::vector<std::string> names;
      for (const KnownModel &known : known_models)
        names.push_back(known.written.name);
      const unsigned int n_before = reader.errors().n_errors();
      const std::string name =
          reader.choice("model", names.front(), names,
                        fmt::format("{}", fmt::join(names, ", ")));
      if (reader.errors().n_errors() > n_before) {
        reader.accept_everything();
        return false;
      }
      for (const KnownModel &known : known_models)
        if (known.written.name == name)
          material.model = known.model;
      material.rigid = material.model == BulkModel::rigid;
      check_model(reader, scene, material.model);
      return true;
    }

    const std::vector<std::string> isotropic_names = {"Young modulus",
                                                      "Poisson ratio"};
    const std::vector<std::string> transverse_names = {
        "axis",
        "axial Young modulus",
        "transverse Young modulus",
        "axial Poisson ratio",
        "transverse Poisson ratio",
        "axial shear modulus"};

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

    /** Why constants of the material are the same everywhere, or nothing. */
    std::string why_uniform(const SceneInput &scene, const BulkModel model)
    {
      if (scene.large_motion)
        return "the scene has motion = large";
      return flows(model) ? "the material flows" : "";
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
      if (!depends(given->text()))
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

    /** Density, and the moduli of an isotropic material. */
    void read_constants(SectionReader &reader, const SceneInput &scene,
                        MaterialInput &material)
    {
      GradedInput constants;
      const std::string uniform = why_uniform(scene, material.model),
                        graded =
                            uniform.empty() ? ", may depend on x, y, z" : "";
      const bool isotropic = !material.rigid && !material.transverse;
      if (isotropic) {
        constants.young =
            read_constant(reader, uniform, isotropic_names[0], units::pressure,
                          Range::positive(), "Pa" + graded);
        // the bulk modulus is infinite at 1/2, the shear modulus at -1
        constants.poisson = read_constant(reader, uniform, isotropic_names[1],
                                          units::none, {-1., 0.5, true, true},
                                          "lateral over axial strain" + graded);
      } else
        reader.refuse(isotropic_names,
                      material.rigid ? "the material is rigid"
                                     : "the material is transversely isotropic "
                                       "and has an axial and a transverse one");
      constants.density =
          read_constant(reader, uniform, "density", units::density,
                        Range::positive(), "kg/m^3" + graded);
      material.young = constant_of(constants.young);
      material.poisson = constant_of(constants.poisson);
      material.density = constant_of(constants.density);
      if (material.transverse)
        material.young = material.poisson =
            std::numeric_limits<double>::quiet_NaN();
      if (!constants.young.is_constant() || !constants.poisson.is_constant() ||
          !constants.density.is_constant())
        material.graded = constants;
    }

    /** Of length 1; in plane problems in the plane or normal to it. */
    std::array<double, 3> read_axis(SectionReader &reader,
                                    const SceneInput &scene)
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
      if (scene.dimension == 3 || axis[2] == 0.)
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

    void read_transverse(SectionReader &reader, const SceneInput &scene,
                         MaterialInput &material)
    {
      if (material.model != BulkModel::transversely_isotropic)
        return reader.refuse(transverse_names,
                             "it needs model = transversely isotropic");
      const unsigned int n_before = reader.errors().n_errors();
      TransverseInput &input = material.transverse.emplace();
      input.axis = read_axis(reader, scene);
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
    }

    void read_viscosity(SectionReader &reader, const SceneInput &scene,
                        MaterialInput &material)
    {
      const std::vector<std::string> names = {"shear viscosity",
                                              "bulk viscosity"};
      if (material.rigid || flows(material.model) || scene.large_motion)
        return reader.refuse(names, material.rigid ? "the material is rigid"
                                    : flows(material.model)
                                        ? "it belongs to elastic materials"
                                        : "it needs motion = small");
      material.shear_viscosity = reader.number(
          names[0], "0", units::viscosity, Range::non_negative(),
          "Pa s, eta of the Kelvin-Voigt stress 2 eta dev(rate) + zeta "
          "tr(rate)");
      material.bulk_viscosity =
          reader.number(names[1], "0", units::viscosity, Range::non_negative(),
                        "Pa s, zeta of it");
      if (material.is_viscous() && scene.dimension == 2 && scene.plane_stress)
        reader.error(material.shear_viscosity > 0. ? names[0] : names[1],
                     "viscosity is not available for plane = stress, where the "
                     "strain normal to the plane has a history of its own",
                     "write plane = strain, or leave it out");
    }

    /** R(p) = isotropic p + Q (1 - exp(-b p)), X = 2/3 kinematic eps_p. */
    void read_hardening(SectionReader &reader, PlasticInput &plastic)
    {
      plastic.yield_stress =
          reader.number("yield stress", "", units::pressure, Range::positive(),
                        "Pa, in uniaxial stress, before any flow");
      plastic.isotropic =
          reader.number("isotropic hardening modulus", "0", units::pressure,
                        Range::non_negative(),
                        "Pa, growth of the yield stress with the flow");
      plastic.kinematic = reader.number(
          "kinematic hardening modulus", "0", units::pressure,
          Range::non_negative(),
          "Pa, of the back stress in uniaxial stress; the middle of the "
          "surface follows the flow");
      plastic.saturation_stress = reader.number(
          "saturation stress", "0", units::pressure, Range::non_negative(),
          "Pa, Q of Q (1 - exp(-b p)), which the yield stress "
          "grows by in the end");
      const std::string exponent = "saturation exponent";
      if (plastic.saturation_stress == 0.)
        reader.refuse({exponent}, "there is no `saturation stress`");
      else
        plastic.saturation_exponent =
            reader.number(exponent, "", units::none, Range::positive(), "b");
    }

    void read_overstress(SectionReader &reader, PlasticInput &plastic)
    {
      constexpr Unit per_time{0, 0, -1};
      plastic.viscosity = reader.number(
          "viscosity", "", units::viscosity, Range::positive(),
          "Pa s, overstress over rate of flow (at the reference rate)");
      plastic.rate_exponent = reader.number(
          "rate exponent", "1", units::none, {1., 1e3, false, false},
          "n: the rate grows like the overstress to the n");
      const std::string rate = "reference rate";
      if (plastic.rate_exponent == 1.)
        reader.refuse({rate}, "it is of no effect where `rate exponent` is 1");
      else
        plastic.reference_rate = reader.number(
            rate, "", per_time, Range::positive(),
            "1/s, r of overstress = viscosity r (rate / r)^(1/n)");
    }

    void read_flow(SectionReader &reader, MaterialInput &material)
    {
      const std::vector<std::string>
          of_surface = {"yield stress", "isotropic hardening modulus",
                        "kinematic hardening modulus", "saturation stress",
                        "saturation exponent"},
          of_rates = {"viscosity", "rate exponent", "reference rate"};
      if (!flows(material.model)) {
        reader.refuse(of_surface, "the material does not flow");
        return reader.refuse(of_rates, "the material does not flow");
      }
      PlasticInput plastic;
      read_hardening(reader, plastic);
      if (material.model == BulkModel::viscoplastic)
        read_overstress(reader, plastic);
      else
        reader.refuse(of_rates, "it belongs to model = viscoplastic");
      material.plastic = plastic;
    }

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

    void read_rigid_bodies(SectionReader &reader, const SceneInput &scene,
                           MaterialInput &material)
    {
      if (scene.large_motion && material.rigid) {
        read_extent(reader, material.rigid_bodies);
        return read_mass(reader, scene.dimension, material.rigid_bodies);
      }
      reader.refuse({"bodies", "surface", "mass", "principal inertia"},
                    material.rigid
                        ? "it needs motion = large; with motion = small each "
                          "cell is a body of its density"
                        : "the material is not rigid");
    }

    void read_fields(SectionReader &reader, const SceneInput &scene,
                     MaterialInput &material)
    {
      for (unsigned int c = 0; c < scene.dimension; ++c) {
        material.initial_displacement[c] = read_initial_expression(
            reader, component_name("initial displacement", c), "0",
            units::length, "m, of x, y, z");
        material.initial_velocity[c] = read_initial_expression(
            reader, component_name("initial velocity", c), "0", units::velocity,
            "m/s, of x, y, z");
        material.body_force[c] =
            reader.expression(component_name("body force", c), "0",
                              units::force_per_volume, "N/m^3, of x, y, z, t");
      }
      refuse_third_component(
          reader, {"initial displacement", "initial velocity", "body force"},
          scene);
    }
  } // namespace

  std::string history_dependent_model(const SceneInput &scene)
  {
    for (const MaterialInput &material : scene.materials)
      if (material.plastic)
        return fmt::format("model = {}", model_name(material.model));
    return "";
  }

  const char *model_name(const BulkModel model)
  {
    for (const KnownModel &known : known_models)
      if (known.model == model)
        return known.written.name.c_str();
    return "";
  }

  std::vector<NamedText> known_bulk_models()
  {
    std::vector<NamedText> models;
    for (const KnownModel &known : known_models)
      models.push_back(known.written);
    return models;
  }

  void read_materials(ParameterFile &file, InputErrors &errors,
                      SceneInput &scene)
  {
    for (ParameterSection *block : file.open_blocks("Material")) {
      SectionReader reader(*block, errors);
      MaterialInput material;
      material.name = block->block_name();
      material.where = read_where(reader, "all", WhereUse::cells, scene,
                                  "all, a group or an expression of x, y, z");
      if (read_model(reader, scene, material)) {
        read_transverse(reader, scene, material);
        read_constants(reader, scene, material);
        read_viscosity(reader, scene, material);
        read_flow(reader, material);
        read_rigid_bodies(reader, scene, material);
        read_fields(reader, scene, material);
      }
      scene.materials.push_back(material);
    }
    if (scene.materials.empty())
      errors.error(file.location(), "the scene has no material",
                   "add for example: subsection Material: bulk");
  }
} // namespace nsfd
