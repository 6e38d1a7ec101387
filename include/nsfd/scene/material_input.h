#pragma once

#include "nsfd/parameters/expression.h"
#include "nsfd/scene/stress_input.h"
#include "nsfd/scene/where_input.h"

#include <array>
#include <memory>
#include <optional>
#include <string>

namespace nsfd
{
  class MaterialModel; // see materials/material_model.h

  /** How the bodies of a material move and strain. */
  enum class MaterialKind {
    small_strain,     ///< linear elastic
    rigid,            ///< not at all
    finite_strain,    ///< by an energy of F^T F
    history_dependent ///< with internal variables; small or finite strain
  };

  /** What a rigid material of a scene with large motions says of its bodies. */
  struct RigidInput {
    bool connected = false; ///< cells that touch are one body, else each is one
    /// the body is the ball (the disc in the plane) around the centre of its
    /// cells that reaches to their farthest corner; only if connected
    bool ball = false;
    /// of each body, in place of those of its cells: kg, and kg m^2 about axes
    /// along x, y, z through the centre of mass; in the plane per thickness,
    /// kg/m and kg m^2/m, about z alone: entry 2
    std::optional<double> mass;
    std::optional<std::array<double, 3>> inertia;
  };

  /** Small strain, the same in all directions across an axis. */
  struct TransverseInput {
    std::array<double, 3> axis{{1., 0., 0.}}; ///< of length 1
    double axial_young = 0., transverse_young = 0.;
    double axial_poisson = 0.;      ///< contraction across over extension along
    double transverse_poisson = 0.; ///< both across the axis
    double axial_shear = 0.;
  };

  /** Constants that differ from place to place, of x, y, z. */
  struct GradedInput {
    Expression young, poisson, density;
  };

  /**
   * Flow on the surface of von Mises, of a plastic or viscoplastic material:
   * |dev sigma - X|_eq <= yield + R(p), R = isotropic p + Q (1 - exp(-b p)),
   * X = 2/3 kinematic times the plastic strain; beyond it by the overstress
   * viscosity r (dp/dt / r)^(1/n).
   */
  struct PlasticInput {
    double yield_stress = 0., isotropic = 0., kinematic = 0.; ///< Pa
    double saturation_stress = 0.;                            ///< Q, Pa
    double saturation_exponent = 0.;                          ///< b
    double viscosity = 0.;      ///< Pa s, at the reference rate; 0: none
    double rate_exponent = 1.;  ///< n
    double reference_rate = 1.; ///< r, 1/s; of no effect where n = 1
  };

  struct MaterialInput {
    std::string name;
    Where where;
    std::string model_name = "linear elastic"; ///< as the file writes it
    std::shared_ptr<const MaterialModel> model;
    MaterialKind kind = MaterialKind::small_strain; ///< of the model
    bool rigid = false;                             ///< of that kind
    RigidInput rigid_bodies;
    /// not a number where there is no such constant: of what is graded, and E
    /// and nu of transversely isotropic materials
    double young = 0., poisson = 0., density = 0.;
    std::optional<GradedInput> graded; ///< if one of them depends on the place
    std::optional<TransverseInput> transverse;
    /// eta, zeta in Pa s of the stress 2 eta dev(rate) + zeta tr(rate) 1
    double shear_viscosity = 0., bulk_viscosity = 0.;
    bool is_viscous() const
    {
      return shear_viscosity > 0. || bulk_viscosity > 0.;
    }
    /// per component, expressions of x, y, z (t = 0); default 0
    std::array<Expression, 3> initial_displacement, initial_velocity;
    std::array<Expression, 3> body_force; ///< N/m^3, of x, y, z, t
    StressInput initial_stress; ///< where there is no strain; 0 if not given
    std::optional<PlasticInput> plastic; ///< of materials with history
  };
} // namespace nsfd
