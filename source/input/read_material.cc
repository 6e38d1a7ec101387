#include "read_sections.h"

#include "mesh/named_mesh.h"
#include "nsfd/materials/material_model.h"

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
    constexpr const char *stress_components[] = {"xx", "yy", "zz",
                                                 "xy", "xz", "yz"};

    std::string stress_name(const unsigned int k)
    {
      return std::string("initial stress ") + stress_components[k];
    }

    GrainTable grains_of(const SceneInput &scene)
    {
      if (scene.mesh.named)
        return grain_table(*scene.mesh.named);
      GrainTable table; // the bodies, from 1
      for (unsigned int b = 0; b < scene.bodies.size(); ++b)
        table.numbers.push_back(b + 1);
      return table;
    }

    /** False if it is none: what the other entries mean is unknown. */
    bool read_model(SectionReader &reader, const SceneInput &scene,
                    const GrainTable &grains, MaterialInput &material)
    {
      const std::vector<std::string> names = material_model_names();
      // Hooke's law in the form that motions of any size allow
      const std::string usual = !scene.large_motion  ? names.front()
                                : scene.plane_stress ? "saint-venant kirchhoff"
                                                     : "neo-hookean";
      const unsigned int n_before = reader.errors().n_errors();
      material.model_name = reader.choice(
          "model", usual, names, fmt::format("{}", fmt::join(names, ", ")));
      if (reader.errors().n_errors() > n_before) {
        reader.accept_everything();
        return false;
      }
      const std::shared_ptr<MaterialModel> model =
          MaterialRegistry::instance().create(material.model_name);
      material.model = model;
      material.kind = model->kind();
      material.rigid = material.kind == MaterialKind::rigid;
      model->read(
          reader,
          {scene.dimension, scene.plane_stress, scene.large_motion, &grains},
          material);
      return true;
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
      if (material.kind == MaterialKind::small_strain && !scene.large_motion)
        material.initial_stress = read_initial_stress(
            reader, scene, "Pa, of x, y, z: where there is no strain");
      else if (scene.large_motion)
        refuse_initial_stress(reader, "with motion = large bodies are "
                                      "without stress where they start");
      else
        refuse_initial_stress(
            reader, fmt::format("bodies of model = {} have no stress without "
                                "strain",
                                material.model_name));
    }

    /** Only the scenes that warm pay for temperatures. */
    void read_heat(SectionReader &reader, const SceneInput &scene,
                   MaterialInput &material)
    {
      const std::string capacity = "heat capacity",
                        text = "J/(kg K): what is dissipated warms the body; "
                               "for all materials or none";
      const std::vector<std::string> others = {"conductivity",
                                               "initial temperature"};
      const std::string share = "plastic heat share";
      if (!reader.optional(capacity, text)) {
        reader.refuse({others[0], others[1], share},
                      "there is no `heat capacity`");
        return;
      }
      HeatOfMaterial &heat = material.heat.emplace();
      heat.capacity = reader.number(capacity, "", units::heat_capacity,
                                    Range::positive(), text);
      heat.conductivity =
          reader.number(others[0], "0", units::conductivity,
                        Range::non_negative(), "W/(m K); 0: adiabatic");
      heat.initial = read_initial_expression(
          reader, others[1], "293.15 K", units::temperature, "K, of x, y, z");
      if (material.kind == MaterialKind::history_dependent)
        heat.plastic_share =
            reader.number(share, "1", units::none, Range::closed(0., 1.),
                          "of the plastic work: what becomes heat");
      else
        reader.refuse({share}, "the material does not flow");
      if (scene.large_motion)
        reader.error(capacity, "motion = large has no temperatures yet",
                     "remove it, or write motion = small");
    }

    /** Every cell has a temperature, or none has. */
    void check_heat(const std::vector<ParameterSection *> &blocks,
                    InputErrors &errors, const SceneInput &scene)
    {
      std::string with;
      for (const MaterialInput &material : scene.materials)
        if (material.heat)
          with = material.name;
      for (std::size_t m = 0; !with.empty() && m < blocks.size(); ++m)
        if (!scene.materials[m].heat)
          errors.error(blocks[m]->location(),
                       fmt::format("material {} has no `heat capacity`, and "
                                   "material {} has",
                                   scene.materials[m].name, with),
                       "give both, or none");
    }

    /** Their cells are stepped by other forces than those of the others. */
    void refuse_with_history(const std::vector<ParameterSection *> &blocks,
                             InputErrors &errors, const SceneInput &scene)
    {
      for (std::size_t m = 0; scene.has_history() && m < blocks.size(); ++m)
        if (scene.materials[m].initial_stress.is_given()) {
          SectionReader reader(*blocks[m], errors);
          refuse_initial_stress(
              reader, fmt::format("the scene has a material with history, {}",
                                  history_dependent_model(scene)));
        }
    }
  } // namespace

  StressInput read_initial_stress(SectionReader &reader,
                                  const SceneInput &scene,
                                  const std::string &text)
  {
    StressInput stress;
    for (unsigned int k = 0; k < 6; ++k) {
      const std::string name = stress_name(k);
      if (scene.dimension == 2 && k > 3)
        reader.refuse({name}, "dimension = 2 has no shear stress along z");
      else if (k == 2 && scene.dimension == 2 && scene.plane_stress)
        reader.refuse({name}, "in plane stress it is 0");
      else if (reader.optional(name, text))
        stress.parts[k] =
            read_initial_expression(reader, name, "", units::pressure, text);
    }
    return stress;
  }

  StressInput read_initial_traction(SectionReader &reader,
                                    const SceneInput &scene)
  {
    if (!scene.iterates())
      return read_initial_stress(reader, scene,
                                 "Pa, of x, y, z: its traction acts on the "
                                 "faces at t = 0; default: that of the cells");
    refuse_initial_stress(
        reader, scene.large_motion ? "with motion = large bodies are "
                                     "without stress where they start"
                                   : "the scene has a material with history");
    return {};
  }

  void refuse_initial_stress(SectionReader &reader, const std::string &reason)
  {
    for (unsigned int k = 0; k < 6; ++k)
      reader.refuse({stress_name(k)}, reason);
  }

  std::string history_dependent_model(const SceneInput &scene)
  {
    for (const MaterialInput &material : scene.materials)
      if (material.kind == MaterialKind::history_dependent)
        return fmt::format("model = {}", material.model_name);
    return "";
  }

  std::vector<NamedText> known_bulk_models()
  {
    std::vector<NamedText> models;
    for (const std::string &name : material_model_names())
      models.push_back(
          {name, MaterialRegistry::instance().entries().at(name).text});
    return models;
  }

  void read_materials(ParameterFile &file, InputErrors &errors,
                      SceneInput &scene)
  {
    const auto blocks = file.open_blocks("Material");
    const GrainTable grains = grains_of(scene);
    for (ParameterSection *block : blocks) {
      SectionReader reader(*block, errors);
      MaterialInput material;
      material.name = block->block_name();
      material.where = read_where(reader, "all", WhereUse::cells, scene,
                                  "all, a group or an expression of x, y, z");
      if (read_model(reader, scene, grains, material)) {
        read_fields(reader, scene, material);
        read_heat(reader, scene, material);
      }
      scene.materials.push_back(material);
    }
    refuse_with_history(blocks, errors, scene);
    check_heat(blocks, errors, scene);
    if (scene.materials.empty())
      errors.error(file.location(), "the scene has no material",
                   "add for example: subsection Material: bulk");
  }
} // namespace nsfd
