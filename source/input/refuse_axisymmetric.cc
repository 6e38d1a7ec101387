#include "read_sections.h"

#include "nsfd/verification/verification_case.h"

#include <fmt/format.h>

namespace nsfd
{
  namespace
  {
    void refuse_materials(ParameterFile &file, InputErrors &errors,
                          const SceneInput &scene)
    {
      const auto blocks = file.open_blocks("Material");
      for (std::size_t m = 0; m < scene.materials.size(); ++m) {
        const MaterialInput &material = scene.materials[m];
        SectionReader reader(*blocks[m], errors);
        if (material.kind == MaterialKind::small_strain
                ? material.is_isotropic()
                : !material.rigid && scene.time.scheme.at_nodes)
          continue;
        reader.error(
            "model",
            fmt::format("model = {} is not available for plane = axisymmetric, "
                        "which has {}",
                        material.model_name,
                        material.rigid
                            ? "no rigid bodies: their only motion would be "
                              "that along the axis"
                        : material.kind == MaterialKind::small_strain
                            ? "isotropic bodies alone"
                            : "linear elastic bodies alone but in explicit "
                              "steps: other laws do not know the strain along "
                              "the hoops"),
            material.rigid || material.kind == MaterialKind::small_strain
                ? "write model = linear elastic"
                : "write scheme = explicit, or model = linear elastic");
      }
    }

    void refuse_discretization(ParameterFile &file, InputErrors &errors,
                               const SceneInput &scene)
    {
      const DiscretizationInput &input = scene.discretization;
      SectionReader reader(file.open("Discretization"), errors);
      if (scene.time.scheme.at_nodes) {
        if (input.degree > 1)
          reader.error("degree",
                       fmt::format("degree = {} with scheme = explicit: nodes "
                                   "on the axis of plane = axisymmetric would "
                                   "have no lumped mass",
                                   input.degree),
                       "write 1, or take scheme = moreau-jean");
        return; // points are at the nodes, which have areas
      }
      if (input.interface_quadrature == "gauss lobatto")
        reader.error("interface quadrature",
                     "interface quadrature = gauss lobatto has points at the "
                     "ends of a face, and one on the axis of plane = "
                     "axisymmetric would have no area",
                     "write gauss");
      if (input.lumped_mass && input.degree > 1)
        reader.error("mass",
                     fmt::format("mass = lumped with degree = {}: nodes on "
                                 "the axis of plane = axisymmetric would have "
                                 "no mass",
                                 input.degree),
                     "write consistent, or degree = 1");
    }

    void refuse_observables(ParameterFile &file, InputErrors &errors,
                            const SceneInput &scene)
    {
      const auto blocks = file.open_blocks("Observable");
      for (std::size_t k = 0; k < scene.observables.size(); ++k)
        if (scene.observables[k].type == "energy release rate") {
          SectionReader reader(*blocks[k], errors);
          reader.error(
              "type",
              "type = energy release rate is not available for "
              "plane = axisymmetric: its integrals are those of the plane",
              "take the opening of the crack faces, type = crack, or "
              "leave it out");
        }
    }
  } // namespace

  void refuse_axisymmetric(ParameterFile &file, InputErrors &errors,
                           const SceneInput &scene)
  {
    SectionReader top(file.top(), errors);
    if (scene.large_motion && !scene.time.scheme.at_nodes)
      top.error("motion",
                "motion = large has explicit steps alone for plane = "
                "axisymmetric: the bodies of implicit ones have no strain "
                "along the hoops",
                "write scheme = explicit, or motion = small");
    for (const ParameterSection *contact : file.open_blocks("Contact"))
      errors.error(contact->location(),
                   "surfaces of bodies do not meet each other with plane = "
                   "axisymmetric: they touch obstacles, and faces of the mesh "
                   "that have parted touch where they are",
                   "leave the block out, or write an Obstacle");
    if (scene.adaptivity)
      errors.error(file.open("Adaptivity").location(),
                   "section `Adaptivity` is not available for plane = "
                   "axisymmetric: what it carries from mesh to mesh is per "
                   "metre of depth",
                   "leave it out, and refine the mesh with `refinements`");
    if (scene.verification && !scene.verification->is_axisymmetric()) {
      SectionReader verification(file.open("Verification"), errors);
      verification.error("case",
                         "this verification case does not know plane = "
                         "axisymmetric: its solution is that of the plane",
                         "leave the section out");
    }
    if (scene.gravity[0] != 0.) {
      SectionReader loads(file.open("Loads"), errors);
      loads.error(
          "gravity",
          fmt::format("gravity = {:g}, {:g} has a part across the axis, "
                      "and plane = axisymmetric has none",
                      scene.gravity[0], scene.gravity[1]),
          fmt::format("write 0, {:g}; a force along the radius is "
                      "`body force x` of a Material",
                      scene.gravity[1]));
    }
    refuse_materials(file, errors, scene);
    refuse_discretization(file, errors, scene);
    refuse_observables(file, errors, scene);
  }
} // namespace nsfd
