#pragma once

#include "nsfd/parameters/expression.h"
#include "nsfd/scene/heat_input.h"
#include "nsfd/scene/stress_input.h"
#include "nsfd/scene/where_input.h"

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

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

  /** Bunge's phi_1, Phi, phi_2 in degrees: about axis 3, the new axis 1, the
      new axis 3, from the axes of the scene to those of the crystal. */
  using EulerAngles = std::array<double, 3>;

  /**
   * The grains of a mesh. A cell has an id: its set of groups where the mesh
   * has groups of its own, else the number of its body, from 0, or its material
   * id.
   */
  struct GrainTable {
    std::vector<unsigned int> numbers; ///< of the grain, by id; empty: the id
    /// what a mesh file says of its cells, by name, then by id
    std::map<std::string, std::vector<EulerAngles>> cell_data;
  };

  /** How the axes of a crystal lie in the scene. */
  struct OrientationInput {
    enum class Kind {
      angles,   ///< of x, y, z
      random,   ///< per grain, uniform in SO(3)
      in_plane, ///< per grain, uniform about z
      table,    ///< per grain
      cell_data ///< per id
    };
    Kind kind = Kind::angles;
    std::array<Expression, 3> angles; ///< degrees
    unsigned int seed = 1;
    std::map<unsigned int, EulerAngles> of_grain; ///< kind table
    std::vector<EulerAngles> of_id;               ///< kind cell_data
    std::vector<unsigned int> numbers;            ///< as in GrainTable
    std::string source;                           ///< of table or data, a name

    bool depends_on_place() const
    {
      return kind == Kind::angles &&
             !(angles[0].is_constant() && angles[1].is_constant() &&
               angles[2].is_constant());
    }
    /** Not the same in all cells. */
    bool varies() const { return kind != Kind::angles || depends_on_place(); }
  };

  /** Hooke's matrix, Pa: rows and columns xx, yy, zz, xy, xz, yz; sigma_ij =
      C_ijkl eps_kl has the entries C_ijkl. */
  using HookeMatrix = std::array<std::array<double, 6>, 6>;

  /** Small strain, any symmetry: cubic or orthotropic in the axes of the
      crystal. */
  struct AnisotropicInput {
    HookeMatrix stiffness{}; ///< in the axes of the crystal
    OrientationInput orientation;
    /// over all directions in space, Pa: rho c^2 of plane waves
    double fastest = 0., slowest = 0.;
    /// Young's modulus, and the mean Poisson's ratio of that direction
    double stiffest_young = 0., stiffest_poisson = 0.;
    double softest_young = 0., softest_poisson = 0.;
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
    double hardening_exponent = 0.; ///< N of a power law in place of R; 0: none
    double viscosity = 0.;          ///< Pa s, at the reference rate; 0: none
    double rate_exponent = 1.;      ///< n
    double reference_rate = 1.;     ///< r, 1/s; of no effect where n = 1
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
    /// and nu of anisotropic materials
    double young = 0., poisson = 0., density = 0.;
    std::optional<GradedInput> graded; ///< if one of them depends on the place
    std::optional<TransverseInput> transverse;
    std::shared_ptr<const AnisotropicInput> anisotropic; ///< null: it is not
    /** Cells of the block have constants of their own. */
    bool varies() const
    {
      return graded || (anisotropic && anisotropic->orientation.varies());
    }
    /** Within a cell, too. */
    bool varies_in_cells() const
    {
      return graded ||
             (anisotropic && anisotropic->orientation.depends_on_place());
    }
    bool is_isotropic() const { return !transverse && !anisotropic; }
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
    std::optional<HeatOfMaterial> heat;  ///< of all materials, or of none
  };
} // namespace nsfd
