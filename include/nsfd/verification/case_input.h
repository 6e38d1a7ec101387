#pragma once

#include "nsfd/scene/scene_input.h"
#include "nsfd/verification/verification_case.h"

#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

/** What several verification cases need to read a scene. */
namespace nsfd::cases
{
  /** @throws std::runtime_error if the scene is not one the case knows. */
  inline void demand(const bool holds, const std::string &sentence)
  {
    if (!holds)
      throw std::runtime_error("Verification: " + sentence);
  }

  /** Relative to the exact value, which may not be 0. */
  inline double relative_error(const double value, const double exact)
  {
    return std::abs(value - exact) / std::abs(exact);
  }

  /** A direction along an axis. */
  struct Direction {
    unsigned int axis = 0;
    double sign = 1.;
  };

  inline Direction direction_of(const std::array<double, 3> &unit_vector)
  {
    for (unsigned int d = 0; d < 3; ++d)
      if (std::abs(std::abs(unit_vector[d]) - 1.) < 1e-12)
        return {d, unit_vector[d]};
    demand(false, "the normal of the obstacle must be along an axis");
    return {};
  }

  /** Outward normal of the side of the box that a block names. */
  inline Direction direction_of(const Where &where)
  {
    const char *const sides[] = {"left", "right", "bottom",
                                 "top",  "back",  "front"};
    if (where.kind == Where::Kind::side)
      for (unsigned int s = 0; s < 6; ++s)
        if (where.name == sides[s])
          return {s / 2, s % 2 == 0 ? -1. : 1.};
    demand(false, "a loaded boundary must be a side: left, right, ...");
    return {};
  }

  inline void demand_box(const SceneInput &input)
  {
    demand(input.mesh.lower.size() == input.dimension &&
               input.mesh.upper.size() == input.dimension,
           "the mesh must be a box with two corners");
  }

  inline double extent(const SceneInput &input, const unsigned int axis)
  {
    return input.mesh.upper[axis] - input.mesh.lower[axis];
  }

  /** Area across an axis; in two dimensions per metre of depth. */
  inline double cross_section(const SceneInput &input, const unsigned int axis)
  {
    double area = 1.;
    for (unsigned int d = 0; d < input.dimension; ++d)
      if (d != axis)
        area *= extent(input, d);
    return area;
  }

  /** Cells along an axis. */
  inline double n_cells(const SceneInput &input, const unsigned int axis)
  {
    return std::ldexp(input.mesh.cells[axis], int(input.mesh.refinements));
  }

  /** The material block that holds at a point. */
  inline const MaterialInput &material_at(const SceneInput &input,
                                          const std::array<double, 3> &x)
  {
    for (const MaterialInput &material : input.materials) {
      const Where &where = material.where;
      if (where.kind == Where::Kind::all ||
          (where.kind == Where::Kind::expression &&
           where.condition(x[0], x[1], x[2]) != 0.))
        return material;
    }
    demand(false, "each material needs where = all or an expression");
    return input.materials.front();
  }

  /** E, rho and c of a bar: elastic, the same everywhere, not contracting. */
  struct Bar {
    double young = 0., density = 0., speed = 0.;

    double impedance() const { return density * speed; }
  };

  inline Bar bar_of(const SceneInput &input)
  {
    demand_box(input);
    const MaterialInput &first = input.materials.front();
    for (const MaterialInput &material : input.materials) {
      demand(!material.rigid && material.young == first.young &&
                 material.density == first.density,
             "a bar is elastic, with one modulus and one density");
      demand(!material.is_viscous(), "the bar must not be viscous");
      demand(material.poisson == 0.,
             "waves in a bar are exact for `Poisson ratio = 0` only");
    }
    return {first.young, first.density, std::sqrt(first.young / first.density)};
  }

  /** The one side that carries a load, and the tension on it at time t. */
  struct LoadedSide {
    Direction normal;
    const BoundaryInput *boundary = nullptr;
    std::array<double, 3> centre{};

    double tension(const double t) const
    {
      const auto &[x, y, z] = centre;
      return normal.sign * boundary->traction[normal.axis](x, y, z, t) -
             boundary->pressure(x, y, z, t);
    }
  };

  inline LoadedSide loaded_side(const SceneInput &input)
  {
    demand_box(input);
    LoadedSide side;
    for (const BoundaryInput &boundary : input.boundaries)
      if (side.boundary == nullptr &&
          (boundary.has_traction || boundary.has_pressure))
        side.boundary = &boundary;
    demand(side.boundary != nullptr, "no boundary has a traction or pressure");
    side.normal = direction_of(side.boundary->where);
    for (unsigned int d = 0; d < input.dimension; ++d)
      side.centre[d] = d != side.normal.axis
                           ? 0.5 * (input.mesh.lower[d] + input.mesh.upper[d])
                           : (side.normal.sign > 0. ? input.mesh.upper
                                                    : input.mesh.lower)[d];
    return side;
  }

  /** The first block with elastic springs. */
  inline const InterfaceInput &elastic_interface(const SceneInput &input)
  {
    for (const InterfaceInput &interface : input.interfaces)
      if (interface.law_name == "elastic")
        return interface;
    demand(false, "an Interface block with law = elastic is missing");
    return input.interfaces.front();
  }

  /** The first block with a cohesive law. */
  inline const InterfaceInput &cohesive_interface(const SceneInput &input)
  {
    for (const InterfaceInput &interface : input.interfaces)
      if (interface.law)
        return interface;
    demand(false, "an Interface block with a cohesive law is missing");
    return input.interfaces.front();
  }

  /** Mean of a member over the volume of all cells. */
  inline double mean(const std::vector<CellState> &cells,
                     std::array<double, 3> CellState::*member,
                     const unsigned int axis)
  {
    double sum = 0., volume = 0.;
    for (const CellState &cell : cells) {
      sum += cell.volume * (cell.*member)[axis];
      volume += cell.volume;
    }
    return sum / volume;
  }

  inline double mechanical_energy(const HistoryRow &row)
  {
    return row.energy.kinetic + row.energy.elastic + row.energy.cohesive;
  }

  /** Boundaries with `motion = exact` move as the solution does. */
  inline void
  set_exact_motion(SceneInput &scene,
                   const std::shared_ptr<const VerificationCase> &exact)
  {
    for (BoundaryInput &boundary : scene.boundaries)
      if (boundary.exact_motion)
        for (unsigned int c = 0; c < scene.dimension; ++c)
          boundary.velocity[c] = Expression(
              [exact, c](const double x, const double y, const double z,
                         const double t) {
                return exact->velocity({x, y, z}, t)[c];
              },
              "exact", true);
  }

  /** A step function that is right-continuous. */
  inline double heaviside(const double x) { return x >= 0. ? 1. : 0.; }
  inline double positive_part(const double x) { return x > 0. ? x : 0.; }
} // namespace nsfd::cases
