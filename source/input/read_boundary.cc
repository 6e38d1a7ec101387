#include "read_sections.h"

#include <fmt/format.h>

namespace nsfd
{
  namespace
  {
    /** @return true if the component is prescribed or loaded. */
    bool read_component(SectionReader &reader, const unsigned int c,
                        BoundaryInput &boundary)
    {
      const std::string velocity = component_name("velocity", c);
      const std::string displacement = component_name("displacement", c);
      const std::string traction = component_name("traction", c);
      boundary.velocity[c] = read_optional_expression(
          reader, velocity, units::velocity, "m/s, of x, y, z, t");
      boundary.displacement[c] = read_optional_expression(
          reader, displacement, units::length, "m, of x, y, z, t");
      const auto load = read_optional_expression(
          reader, traction, units::pressure, "Pa, of x, y, z, t");
      if (load) {
        boundary.traction[c] = *load;
        boundary.has_traction = true;
      }

      const bool is_driven = boundary.velocity[c].has_value() ||
                             boundary.displacement[c].has_value();
      if (boundary.velocity[c] && boundary.displacement[c])
        reader.error(
            displacement,
            fmt::format("`{}` and `{}` are both given", velocity, displacement),
            "keep one of the two");
      if (load && is_driven)
        reader.error(traction,
                     fmt::format("`{}` has no effect: the motion of this "
                                 "component is prescribed",
                                 traction),
                     "keep one of the two");
      return load || is_driven;
    }

    /**
     * Equations in time meet a motion exactly at every point: where cells share
     * nodes, one that is not uniform needs its points at the nodes.
     */
    void check_points(SectionReader &reader, const SceneInput &scene,
                      const BoundaryInput &boundary)
    {
      const DiscretizationInput &space = scene.discretization;
      const bool at_nodes = space.interface_quadrature == "gauss lobatto" &&
                            space.interface_points == space.degree + 1;
      bool varies = boundary.exact_motion;
      for (unsigned int c = 0; c < scene.dimension; ++c)
        for (const auto *given :
             {&boundary.velocity[c], &boundary.displacement[c]})
          varies = varies || (*given && (*given)->depends_on_position());
      if (scene.time.scheme.smooth && scene.has_bonded_faces() && varies &&
          !at_nodes)
        reader.error("motion",
                     fmt::format("cells that share nodes cannot follow this "
                                 "motion at {} points of the rule `{}` on a "
                                 "face with scheme = arkode",
                                 space.interface_points,
                                 space.interface_quadrature),
                     fmt::format("write in section Discretization: set "
                                 "interface quadrature = gauss lobatto and set "
                                 "interface points = {}",
                                 space.degree + 1));
    }

    void read_absorbing(SectionReader &reader, const SceneInput &scene,
                        const bool is_driven, BoundaryInput &boundary)
    {
      boundary.absorbs = reader.boolean(
          "absorbing", false,
          "true: waves that come in along the normal leave; -rho c v per area, "
          "c_p along the normal and c_s across it");
      if (!boundary.absorbs)
        return;
      if (is_driven)
        reader.error("absorbing",
                     "a side whose motion is prescribed absorbs nothing",
                     "give the motion a Boundary block of its own, or write "
                     "absorbing = false");
      if (scene.iterates())
        reader.error(
            "absorbing",
            fmt::format("absorbing = true is for linear elastic bodies in "
                        "small motions, and the scene has {}",
                        scene.large_motion ? "motion = large"
                                           : history_dependent_model(scene)),
            "write absorbing = false and a mesh so large that no wave comes "
            "back");
    }

    /** True if something is given. */
    bool read_heat(SectionReader &reader, const SceneInput &scene,
                   BoundaryInput &boundary)
    {
      const std::string temperature = "temperature", flux = "heat flux";
      bool conducts = false;
      for (const MaterialInput &material : scene.materials)
        conducts |= material.heat && material.heat->conductivity > 0.;
      if (!conducts) {
        reader.refuse({temperature, flux},
                      scene.has_heat() ? "no material has a conductivity"
                                       : "no material has a heat capacity");
        return false;
      }
      boundary.temperature = read_optional_expression(
          reader, temperature, units::temperature, "K, of x, y, z, t");
      boundary.heat_flux = read_optional_expression(
          reader, flux, units::heat_flux, "W/m^2 into the body, of x, y, z, t");
      if (boundary.temperature && boundary.heat_flux)
        reader.error(flux, "`temperature` and `heat flux` are both given",
                     "keep one of the two");
      return boundary.temperature || boundary.heat_flux;
    }

    BoundaryInput read_boundary(SectionReader &reader, const SceneInput &scene)
    {
      BoundaryInput boundary;
      boundary.name = reader.block_name();
      boundary.where =
          read_where(reader, where_by_name(boundary.name, scene),
                     WhereUse::boundary_faces, scene,
                     "left, right, bottom, top, front, back, all, a group or "
                     "an expression");
      boundary.exact_motion =
          reader.choice("motion", "given", {"given", "exact"},
                        "given, or exact: that of the verification case") ==
          "exact";
      bool has_effect = boundary.exact_motion, has_driven = has_effect;
      for (unsigned int c = 0; c < scene.dimension; ++c) {
        const bool here = read_component(reader, c, boundary);
        if (here && boundary.exact_motion)
          reader.error("motion",
                       "motion = exact leaves nothing else to prescribe",
                       "keep one of the two");
        has_effect = here || has_effect;
        has_driven =
            has_driven || boundary.velocity[c] || boundary.displacement[c];
      }
      check_points(reader, scene, boundary);
      refuse_third_component(reader, {"velocity", "displacement", "traction"},
                             scene);
      if (const auto pressure = read_optional_expression(
              reader, "pressure", units::pressure,
              scene.large_motion
                  ? "Pa, of x, y, z, t; pushes on the body: a dead load, "
                    "along the normal and per area of t = 0"
                  : "Pa, of x, y, z, t; pushes on the body")) {
        boundary.pressure = *pressure;
        boundary.has_pressure = true;
      }
      read_absorbing(reader, scene, has_driven, boundary);
      has_effect = read_heat(reader, scene, boundary) || has_effect;
      if (!has_effect && !boundary.has_pressure && !boundary.absorbs)
        reader.error("",
                     fmt::format("section `{}` prescribes nothing",
                                 reader.section_name()),
                     "write for example: set velocity x = 0");
      return boundary;
    }
  } // namespace

  std::optional<Expression> read_optional_expression(SectionReader &reader,
                                                     const std::string &name,
                                                     const Unit unit,
                                                     const std::string &text)
  {
    if (!reader.optional(name, text))
      return {};
    return reader.expression(name, "", unit, text);
  }

  void read_boundaries(ParameterFile &file, InputErrors &errors,
                       SceneInput &scene)
  {
    for (ParameterSection *block : file.open_blocks("Boundary")) {
      SectionReader reader(*block, errors);
      scene.boundaries.push_back(read_boundary(reader, scene));
    }
  }

  void read_loads(ParameterFile &file, InputErrors &errors, SceneInput &scene)
  {
    SectionReader reader(file.open("Loads"), errors);
    const std::vector<double> gravity =
        reader.numbers("gravity", scene.dimension == 2 ? "0, 0" : "0, 0, 0",
                       units::acceleration, Range::any(), scene.dimension,
                       "m/s^2, one value per direction");
    for (unsigned int d = 0; d < scene.dimension; ++d)
      scene.gravity[d] = gravity[d];
  }
} // namespace nsfd
