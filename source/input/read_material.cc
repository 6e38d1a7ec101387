#include "read_sections.h"

#include <fmt/format.h>

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
    void read_elasticity(SectionReader &reader, MaterialInput &material)
    {
      const std::vector<std::string> names = {"Young modulus", "Poisson ratio"};
      if (material.rigid)
        return reader.refuse(names, "the material is rigid");
      material.young =
          reader.number(names[0], "", units::pressure, Range::positive(), "Pa");
      // the bulk modulus is infinite at 1/2, the shear modulus at -1
      material.poisson =
          reader.number(names[1], "", units::none, {-1., 0.5, true, true},
                        "lateral over "
                        "axial strain");
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

  void read_materials(ParameterFile &file, InputErrors &errors,
                      SceneInput &scene)
  {
    for (ParameterSection *block : file.open_blocks("Material")) {
      SectionReader reader(*block, errors);
      MaterialInput material;
      material.name = block->block_name();
      material.where = read_where(reader, "all", WhereUse::cells, scene,
                                  "all, a group or an expression of x, y, z");
      material.rigid =
          reader.choice("model", "linear elastic", {"linear elastic", "rigid"},
                        "linear elastic or rigid") == "rigid";
      read_elasticity(reader, material);
      material.density = reader.number("density", "", units::density,
                                       Range::positive(), "kg/m^3");
      read_fields(reader, scene, material);
      scene.materials.push_back(material);
    }
    if (scene.materials.empty())
      errors.error(file.location(), "the scene has no material",
                   "add for example: subsection Material: bulk");
  }
} // namespace nsfd
