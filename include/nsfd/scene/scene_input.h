#pragma once

#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/cohesive_laws/scatter.h"
#include "nsfd/parameters/expression.h"

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * What a parameter file says, checked and typed: plain data, in SI or the
   * bare units of the scene. Built by read_scene(); every other part reads
   * this and never the file. Vectors per component have `dim` used entries.
   */
  struct SceneInput;
  struct NamedMesh; // see mesh/named_mesh.h
  class VerificationCase;
  class Indicator;  // see adaptivity/indicator.h
  class Observable; // see postprocess/observable.h

  /** `where`: all | boundary or material words | a group | a condition. */
  struct Where {
    enum class Kind {
      all,
      side,  ///< left right bottom top back front of the bounding box
      group, ///< a named group of the mesh (material or boundary id)
      between_materials, ///< faces between two material blocks
      between_groups,    ///< faces between two groups of cells
      expression         ///< non-zero at the midpoint of face or cell
    };
    Kind kind = Kind::all;
    std::string name; ///< side or group
    /// names, of materials or groups; empty = any two different
    std::array<std::string, 2> materials;
    Expression condition;
  };

  struct MeshInput {
    /// rectangle, brick, notched plate, crossed triangles, diagonal triangles,
    /// tetrahedra, bodies (from `Body:` blocks), file, voronoi, or a deal.II
    /// generator's name
    std::string type = "rectangle";
    std::vector<double> lower, upper; ///< dim entries
    std::vector<unsigned int> cells;  ///< per direction, dim entries
    unsigned int refinements = 0;
    double distortion = 0.; ///< share of the cell size, interior vertices
    unsigned int seed = 1;
    /// notched plate: a slot of `notch_width` (0: none removed, use a
    /// pre-crack) from the left side to `notch_length` at height `notch_height`
    double notch_length = 0., notch_width = 0., notch_height = 0.;
    std::string generator_arguments; ///< "a : b : c" as deal.II takes them
    /// file, voronoi: in the units of the scene
    std::shared_ptr<const NamedMesh> named;
    /// triangles into three quads, tetrahedra into four hexes, at the midpoints
    bool split_simplices = false;
  };

  /** One of several bodies in a mesh of type `bodies`. */
  struct BodyInput {
    std::string name;
    MeshInput mesh;
    double separation = 0.;
  };

  struct DiscretizationInput {
    unsigned int degree = 1;
    bool lumped_mass = false;
    std::string interface_quadrature =
        "gauss"; ///< gauss | gauss lobatto | quarter points
    unsigned int interface_points = 2; ///< per direction of a face
  };

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
    std::optional<PlasticInput> plastic;  ///< of materials with history
  };

  /** What sliding does to the surfaces in contact. */
  struct SlidingInput {
    double dilatancy = 0.; ///< tan(psi): u_N >= d(s), d(s) = s tan(psi)
    double saturation = std::numeric_limits<double>::infinity(); ///< of d, m
    double wear = 0.; ///< k of d(gap)/dt = k p_N |U_T|, 1/Pa

    bool lifts() const { return dilatancy > 0. || wear > 0.; }
  };

  enum class IntactFaces {
    spring,
    unilateral,
    rigid,
    bonded ///< through the bulk, see delassus/bonded.h
  };

  struct InterfaceInput {
    std::string name;
    Where where;
    /// "rigid", "bonded", "elastic", "contact" or the name of a cohesive law
    std::string law_name;
    /// for cohesive laws
    std::shared_ptr<const CohesiveLaw> law;
    /// for `elastic`: C_N, C_T in Pa/m
    double normal_stiffness = 0., tangential_stiffness = 0.;
    /// for cohesive laws: strength and toughness over those of the law
    Expression strength_factor{1.}, toughness_factor{1.}; ///< of x, y, z
    Scatter strength_scatter, toughness_scatter;
    unsigned int seed = 1;
    double friction = 0.;
    /// kappa = (1-beta)^exponent; 0 means kappa = 1
    double friction_exponent = 1.;
    double restitution = 0.;
    bool has_broken = false;
    Expression broken; ///< points where it is not zero start at beta = 0
    IntactFaces intact = IntactFaces::spring;
    bool plateau = false; ///< extrinsic: T(d_m) also while closing, (5)
    double opening_viscosity = 0.; ///< eta in Pa s/m, while beta > 0
    double viscous_limit = std::numeric_limits<double>::infinity(); ///< Pa
    SlidingInput sliding;
    /// Pa, of x, y, z, t: on the crack faces of points with beta <= threshold
    std::optional<Expression> crack_pressure;
    double pressure_threshold = 0.;
    /// beta up to which a point is broken: above 0 for laws with a tail
    double broken_beta() const
    {
      return law && std::isinf(law->final_opening()) ? 1e-3 : 0.;
    }
  };

  struct BoundaryInput {
    std::string name;
    Where where;
    /// prescribed motion per component: velocity, or displacement (then its
    /// time derivative is what the rows prescribe, exactly per step)
    std::array<std::optional<Expression>, 3> velocity, displacement;
    std::array<Expression, 3> traction; ///< Pa, per component
    bool has_traction = false;
    Expression pressure; ///< Pa, positive pushes on the body
    bool has_pressure = false;
    bool exact_motion = false; ///< of the verification case
  };

  class ObstacleShape; // see obstacles/obstacle_shape.h

  /** A rigid half space, ball or cylinder; boundary faces may touch it. */
  struct ObstacleInput {
    std::string name;
    Where where;                      ///< boundary faces that may touch it
    std::string shape_name = "plane"; ///< as the file writes it
    std::shared_ptr<const ObstacleShape> shape;
    std::array<double, 3> point{}; ///< on the plane, centre, or on the axis
    /// of a plane, out of the obstacle; axis of a cylinder; unit length
    std::array<double, 3> normal{};
    double radius = 0.;
    bool hollow = false; ///< bodies are inside: a shell, a drum, a pipe
    /// of the whole obstacle, m/s, functions of t; all empty: it stands still
    std::array<std::optional<Expression>, 3> velocity;
    double friction = 0., restitution = 0.;
    SlidingInput sliding;

    bool moves() const { return velocity[0] || velocity[1] || velocity[2]; }
  };

  /** Contact between any two surfaces, of scenes with large motions. */
  struct ContactInput {
    std::string name;
    /// of the two bodies, in any order; empty: any. The first block that
    /// holds for two materials is theirs; without one they do not touch
    std::array<std::string, 2> materials;
    double friction = 0., restitution = 0.;
    SlidingInput sliding; ///< wear only
  };

  /** A place of a rigid body that stays where it is, in large motions. */
  struct PinInput {
    std::string name;
    std::string material;       ///< of the body; it has one body
    std::array<double, 3> at{}; ///< at t = 0, in the body or outside, m
  };

  enum class CohesionRule { exact, end_point, end_velocity };
  enum class ContactTarget { energy_safe, velocity, position };
  /** The velocity that friction opposes. */
  enum class Sliding {
    velocity,   ///< of the end of the step
    increment,  ///< the mean of the step
    energy_safe ///< that of the end, the mean where friction would give energy
  };
  enum class StepKind { time, courant, automatic };

  enum class Scheme {
    moreau_jean,
    explicit_moreau_jean, ///< with the forces of the bodies at t_k
    arkode                ///< smooth scenes, by SUNDIALS
  };

  struct TimeInput {
    Scheme scheme = Scheme::moreau_jean;
    double end = 0.;
    StepKind step_kind = StepKind::courant;
    /// s, or Courant number h c_p / L; the largest step for `auto`
    double step = 0.5;
    double theta = 0.5;
    double forecast_gamma1 = 0.5, forecast_gamma2 = 0.;
    CohesionRule cohesion_rule = CohesionRule::exact;
    ContactTarget contact_target = ContactTarget::energy_safe;
    Sliding sliding = Sliding::energy_safe;
    unsigned int maximum_bisections = 10;
    double largest_overshoot = 0.05; ///< of the strength of a bonded point
    /// of scheme = arkode: implicit (SDIRK) or explicit Runge-Kutta pairs,
    /// their order and the error per step relative to the largest motion
    bool implicit_pairs = false;
    unsigned int order = 5;
    double tolerance = 1e-9;

    /** Weight of the new velocity in the forces of the bodies. */
    double bulk_theta() const
    {
      return scheme == Scheme::explicit_moreau_jean ? 0. : theta;
    }

    /**
     * How long the forces of the bodies act in a step of length @p h behind one
     * of @p last (0: none). Explicit velocities are those of the middle of a
     * step, from one middle to the next; otherwise every change of the step
     * would move the energy that the scheme keeps, by as much as there is in
     * the fastest modes.
     */
    double kick(const double h, const double last) const
    {
      return scheme == Scheme::explicit_moreau_jean && last > 0.
                 ? (h + last) / 2.
                 : h;
    }

    /** Weight of the new velocity in the work of impulses and loads. */
    double work_theta() const
    {
      return scheme == Scheme::explicit_moreau_jean ? 0.5 : theta;
    }
  };

  /** What a run does where no equilibrium continues the last one. */
  enum class SolutionJump {
    stop,    ///< ends with the last equilibrium
    dynamic, ///< goes on from it with Moreau-Jean
    relax    ///< takes the next equilibrium, counts the released energy
  };

  /** Equilibria: at the start, and from step to step of the load. */
  struct StaticInput {
    bool steps = false; ///< scheme = quasi-static, else the start alone
    double until = 0.;  ///< s, end of the quasi-static steps
    double step = 0.;   ///< s, of the load
    SolutionJump at_jump = SolutionJump::stop;
    double tolerance = 1e-11; ///< unbalanced force, relative to those present
  };

  struct SolverInput {
    std::string method = "auto"; ///< auto | dual newton | gauss seidel
    std::string path = "auto";   ///< auto | local | assembled
    std::string linear_solver =
        "auto"; ///< of the assembled path: auto | direct | cg
    double tolerance = 1e-8;
    unsigned int maximum_iterations = 200;
    /// none | hard | all: steps whose contacts become stored problems
    std::string save_problems = "none";
  };

  /** Section `Adaptivity` with the blocks `Indicator: name`. */
  struct AdaptivityInput {
    unsigned int levels = 2; ///< the smallest cell: that of the mesh / 2^levels
    unsigned int coarsen_every = 10; ///< steps; 0: cells stay small
    /// springs of intrinsic laws on smaller cells: the modulus of the body or
    /// the stiffness of every face stays
    bool constant_modulus = true;
    std::vector<std::shared_ptr<const Indicator>> indicators;
  };

  struct OutputInput {
    std::string directory;
    double fields_every = 0.;            ///< s; 0: start and end only
    unsigned int fields_every_steps = 0; ///< 0: not used
    bool fields = true, report = true;
    bool hdf5 = false;                 ///< fields as HDF5 with XDMF, not as VTU
    unsigned int checkpoint_steps = 0; ///< 0: not by steps
    double checkpoint_seconds = 0.;    ///< of wall time; 0: not by time
  };

  /** A block `Observable: name`. */
  struct ObservableInput {
    std::string name, type;
    unsigned int every = 1; ///< accepted steps from row to row
    std::shared_ptr<Observable> observable;
  };

  struct SceneInput {
    std::string file;               ///< as given on the command line
    std::string title, description; ///< opening comment paragraph of the file
    unsigned int dimension = 2;
    bool plane_stress = false;
    MeshInput mesh;
    std::vector<BodyInput> bodies;
    DiscretizationInput discretization;
    std::vector<MaterialInput> materials;
    std::vector<InterfaceInput> interfaces;
    std::vector<BoundaryInput> boundaries;
    std::vector<ObstacleInput> obstacles;
    /// rotations and strains of any size; false: bodies turn and strain little
    bool large_motion = false;
    std::vector<ContactInput> contacts; ///< only with large motions
    std::vector<PinInput> pins;         ///< only with large motions
    std::array<double, 3> gravity{};    ///< m/s^2
    TimeInput time;
    SolverInput solver;
    OutputInput output;
    /// section `Verification`: exact solution or exact quantities; may be null
    std::shared_ptr<VerificationCase> verification;
    /// complete echo: running it again reproduces the run
    std::string echo;
    /// only if the scene asks for equilibria
    std::optional<StaticInput> statics;
    /// only if the mesh follows the motion
    std::optional<AdaptivityInput> adaptivity;
    std::vector<ObservableInput> observables;
    bool has_viscous_bodies() const
    {
      for (const auto &material : materials)
        if (material.is_viscous())
          return true;
      return false;
    }

    bool has_bonded_faces() const
    {
      for (const auto &block : interfaces)
        if (block.intact == IntactFaces::bonded)
          return true;
      return false;
    }
    /** Materials that keep how they were strained. */
    bool has_history() const
    {
      for (const auto &material : materials)
        if (material.kind == MaterialKind::history_dependent)
          return true;
      return false;
    }
    /** A step is solved by iterations around linear ones. */
    bool iterates() const { return large_motion || has_history(); }
    /** Whether a step in time can come. */
    bool may_move() const
    {
      return !statics || !statics->steps || statics->until < time.end ||
             statics->at_jump == SolutionJump::dynamic;
    }
  };

  /** Somewhere, on whatever rank: dilatancy or wear, and the like. */
  bool has_sliding_lift(const SceneInput &input);
  bool has_opening_viscosity(const SceneInput &input);
  bool has_crack_pressure(const SceneInput &input);
} // namespace nsfd
