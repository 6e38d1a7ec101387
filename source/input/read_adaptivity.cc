#include "cohesive_laws/stiffened_law.h"
#include "nsfd/adaptivity/indicator.h"
#include "read_sections.h"

#include <fmt/format.h>

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /** Parts that do not know triangles that are bisected. */
    void check_bisection(SectionReader &reader, const SceneInput &scene)
    {
      const auto refuse = [&](const bool bad, const std::string &what,
                              const std::string &advice) {
        if (bad)
          reader.error("levels", what, advice);
      };
      refuse(scene.dimension == 3,
             "triangles are bisected, tetrahedra are not yet",
             "remove the section Adaptivity, or take hexes");
      for (const MaterialInput &material : scene.materials)
        refuse(material.rigid || material.graded || material.is_viscous() ||
                   !material.is_isotropic(),
               fmt::format("cells of material `{}` are not bisected yet: it is "
                           "rigid, anisotropic, graded or viscous",
                           material.name),
               "make it linear elastic and uniform, take quads or hexes, or "
               "remove the section Adaptivity");
      for (const InterfaceInput &block : scene.interfaces) {
        refuse((block.law && !block.law->extrinsic()) ||
                   block.law_name == "elastic",
               fmt::format("faces of Interface: {} are springs, and new faces "
                           "inside a cell that is bisected have none",
                           block.name),
               "take an extrinsic law, or remove the section Adaptivity");
        refuse(block.crack_pressure.has_value(),
               fmt::format("Interface: {} has a pressure in its cracks, which "
                           "bisection does not carry on yet",
                           block.name),
               "remove it, or the section Adaptivity");
      }
    }

    /** Parts that do not know a mesh that changes. */
    void check_scene(SectionReader &reader, const SceneInput &scene)
    {
      const auto refuse = [&](const bool bad, const std::string &what,
                              const std::string &advice) {
        if (bad)
          reader.error("levels", what, advice);
      };
      if (scene.large_motion)
        return refuse(true,
                      "the mesh of scenes with motion = large does not change",
                      "remove the section Adaptivity, or write motion = small");
      if (scene.has_history())
        return refuse(true,
                      fmt::format("the mesh of scenes with {} does not change",
                                  history_dependent_model(scene)),
                      "remove the section Adaptivity, or write model = linear "
                      "elastic");
      refuse(scene.has_heat(),
             "new cells would not know their temperatures yet",
             "remove the section Adaptivity, or the heat capacities");
      refuse(scene.has_initial_stress() &&
                 std::any_of(scene.interfaces.begin(), scene.interfaces.end(),
                             [](const InterfaceInput &block) {
                               return block.law_name == "elastic" ||
                                      (block.law && !block.law->extrinsic());
                             }),
             "new faces with springs would not carry the initial stress",
             "remove the section Adaptivity, or take extrinsic laws and law = "
             "joined");
      if (scene.time.scheme.at_nodes && has_simplices(scene))
        return check_bisection(reader, scene);
      refuse(has_simplices(scene),
             "with this scheme only meshes of quads and hexes can change: "
             "triangles and "
             "tetrahedra have no non-conforming faces",
             "take such a mesh, `split simplices = true`, or triangles with "
             "scheme = explicit");
      refuse(
          !scene.time.scheme.at_nodes &&
              std::any_of(scene.materials.begin(), scene.materials.end(),
                          [](const auto &material) { return material.rigid; }),
          "cells of rigid bodies cannot be refined",
          "make all materials elastic, or remove the section Adaptivity");
      for (const auto &obstacle : scene.obstacles)
        refuse(obstacle.cohesion >= 0,
               fmt::format("bodies stick to Obstacle: {}, and new faces there "
                           "would not know what they have carried",
                           obstacle.name),
               "remove its `law`, or the section Adaptivity");
      refuse(scene.statics && !scene.time.scheme.at_nodes,
             "the mesh of equilibria does not change yet",
             "remove the section Adaptivity, or start from rest");
      refuse(scene.time.scheme.smooth,
             "the mesh does not change with scheme = arkode",
             "write scheme = moreau-jean or symplectic");
      refuse(scene.time.scheme.explicit_forces &&
                 scene.adaptivity->levels > scene.time.maximum_bisections,
             fmt::format("the stable step of the explicit scheme halves with "
                         "every level, and {} bisections are allowed",
                         scene.time.maximum_bisections),
             fmt::format("write in section Time: set maximum bisections = {}",
                         scene.adaptivity->levels));
    }

    /** Laws whose springs cannot become stiffer. */
    void check_springs(SectionReader &reader, const SceneInput &scene)
    {
      for (const auto &block : scene.interfaces) {
        if (!block.law || block.law->extrinsic())
          continue;
        const std::string why = not_stiffened(*block.law);
        if (!why.empty())
          reader.error(
              "springs",
              fmt::format("the law {} of Interface: {} {}: its springs "
                          "cannot become stiffer on smaller cells",
                          block.law_name, block.name, why),
              "write springs = constant stiffness, which lowers the "
              "modulus of the body where cells are small, or take a "
              "law with one damage scalar and no viscosity of damage");
      }
    }

    std::shared_ptr<const Indicator> read_indicator(ParameterSection &section,
                                                    InputErrors &errors)
    {
      SectionReader reader(section, errors);
      const auto &registry = IndicatorRegistry::instance();
      const std::string type = read_registered_name(
          reader, "type", "process zone", registry.names());
      if (!registry.knows(type)) {
        reader.accept_everything();
        return nullptr;
      }
      return registry.create(type, reader);
    }
  } // namespace

  void read_adaptivity(ParameterFile &file, InputErrors &errors,
                       SceneInput &scene)
  {
    const auto blocks = file.open_blocks("Indicator");
    if (!file.has_section("Adaptivity")) {
      for (ParameterSection *block : blocks)
        errors.error(block->location(),
                     "an indicator changes no mesh by itself",
                     "add a section: subsection Adaptivity / set levels = 2 / "
                     "end");
      for (ParameterSection *block : blocks)
        read_indicator(*block, errors);
      return;
    }
    SectionReader reader(file.open("Adaptivity"), errors);
    auto &adaptivity = scene.adaptivity.emplace();
    adaptivity.levels =
        reader.integer("levels", "2", 0, 12,
                       "the smallest cell is 2^levels times smaller than that "
                       "of the mesh; 0: the mesh stays as it is");
    adaptivity.bisects = scene.time.scheme.at_nodes && has_simplices(scene);
    const bool changes = !scene.time.scheme.at_nodes;
    adaptivity.coarsen_every =
        reader.integer("coarsen every steps",
                       changes || adaptivity.bisects ? "10" : "0", 0, 1000000,
                       "cells without damage may be coarsened; 0: never; "
                       "triangles: whenever others are refined");
    if (!changes && !adaptivity.bisects && adaptivity.coarsen_every > 0)
      reader.error(
          "coarsen every steps",
          fmt::format("with scheme = explicit cells do not grow again: not "
                      "every {} steps",
                      adaptivity.coarsen_every),
          "write 0, or scheme = moreau-jean or symplectic");
    if (adaptivity.bisects)
      adaptivity.ahead = reader.number(
          "ahead", "1", units::none, Range::non_negative(),
          "of triangles: in cohesive zones, further than the indicators ask "
          "for, so that the mesh changes seldom");
    adaptivity.constant_modulus =
        reader.choice("springs", "constant modulus",
                      {"constant modulus", "constant stiffness"},
                      "of intrinsic laws on smaller cells: as stiff as keeps "
                      "the modulus of the body, or as stiff as the law says") ==
        "constant modulus";
    check_scene(reader, scene);
    if (adaptivity.constant_modulus && !adaptivity.bisects)
      check_springs(reader, scene);
    for (ParameterSection *block : blocks)
      if (auto indicator = read_indicator(*block, errors))
        adaptivity.indicators.push_back(std::move(indicator));
    const bool fit =
        std::all_of(adaptivity.indicators.begin(), adaptivity.indicators.end(),
                    [&](const auto &indicator) {
                      return adaptivity.bisects
                                 ? indicator->is_of_points()
                                 : changes || indicator->is_fixed();
                    });
    if (!fit && adaptivity.bisects)
      reader.error("levels",
                   "triangles are bisected by indicators that look at points "
                   "and places alone",
                   "take indicators of type = process zone or region");
    else if (!fit)
      reader.error("levels",
                   "with scheme = explicit the mesh does not change in a run "
                   "yet: it is refined before it",
                   "take indicators of type = region alone, or write scheme = "
                   "moreau-jean or symplectic");
    if (blocks.empty())
      reader.error("levels", "no indicator says where cells are to be small",
                   "add for example: subsection Indicator: front / set type = "
                   "process zone / end");
    if (adaptivity.levels == 0)
      scene.adaptivity.reset();
  }
} // namespace nsfd
