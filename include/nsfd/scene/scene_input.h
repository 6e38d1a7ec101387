#pragma once

#include "nsfd/scene/adaptivity_input.h"
#include "nsfd/scene/boundary_input.h"
#include "nsfd/scene/contact_input.h"
#include "nsfd/scene/interface_input.h"
#include "nsfd/scene/material_input.h"
#include "nsfd/scene/mesh_input.h"
#include "nsfd/scene/obstacle_input.h"
#include "nsfd/scene/output_input.h"
#include "nsfd/scene/sliding_input.h"
#include "nsfd/scene/solver_input.h"
#include "nsfd/scene/static_input.h"
#include "nsfd/scene/time_input.h"
#include "nsfd/scene/where_input.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  class VerificationCase;

  struct SceneInput;

  /** The same scene with explicit steps, where it can be. */
  struct AutomaticScheme {
    std::shared_ptr<const SceneInput> longest_steps; ///< with step = auto
    /// with the step of the scene, if it names one
    std::shared_ptr<const SceneInput> given_steps;
    std::string refused;       ///< why there is none, a sentence
    std::string implicit_echo; ///< SceneInput::echo, if there are none
  };

  /**
   * What a parameter file says, checked and typed: plain data, in SI or the
   * bare units of the scene. Built by read_scene(); every other part reads
   * this and never the file. Vectors per component have `dim` used entries.
   */
  struct SceneInput {
    std::string file;               ///< as given on the command line
    std::string title, description; ///< opening comment paragraph of the file
    unsigned int dimension = 2;
    bool plane_stress = false;
    /// x is the distance r from the axis and y the height z; volumes, areas,
    /// forces and energies are per radian: r dx dy, r ds
    bool axisymmetric = false;
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
    /// they are solved for the motion of the nodes of all bodies
    bool equilibria_at_nodes = false;
    /// only if the mesh follows the motion, or is refined before it
    std::optional<AdaptivityInput> adaptivity;
    std::vector<ObservableInput> observables;
    /// what `scheme = auto` says besides the scene with implicit steps; or null
    std::shared_ptr<const AutomaticScheme> automatic;
    /// with explicit steps, of a scene that names no scheme; or null
    std::shared_ptr<const AutomaticScheme> alternative;
    std::string scheme_choice; ///< what `scheme = auto` has found; or empty
    /** In the run; quads and hexes of explicit steps are refined before it. */
    bool mesh_changes() const
    {
      return adaptivity && (!time.scheme.at_nodes || adaptivity->bisects);
    }
    bool has_viscous_bodies() const
    {
      for (const auto &material : materials)
        if (material.is_viscous())
          return true;
      return false;
    }

    /** Of cells or of faces. */
    bool has_initial_stress() const
    {
      for (const auto &material : materials)
        if (material.initial_stress.is_given())
          return true;
      for (const auto &block : interfaces)
        if (block.initial_stress.is_given())
          return true;
      return false;
    }
    /** What is dissipated warms the bodies. */
    bool has_heat() const { return !materials.empty() && materials[0].heat; }
    bool has_absorbing_sides() const
    {
      for (const auto &boundary : boundaries)
        if (boundary.absorbs)
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
    /** Share of critical damping of fronts in explicit steps. */
    double front_viscosity() const;
    bool has_rigid_bodies() const
    {
      for (const auto &material : materials)
        if (material.rigid)
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
    /**
     * Bodies touch others, or some do not deform: every rank knows all cells.
     * Only in large motions; explicit steps need it for these alone.
     */
    bool has_body_table() const
    {
      return large_motion && (!time.scheme.at_nodes || has_rigid_bodies() ||
                              !contacts.empty() || !obstacles.empty());
    }
    /** The load time of equilibria is an unknown: it may run backwards. */
    bool follows_path() const
    {
      return statics && statics->steps &&
             statics->at_jump == SolutionJump::arc_length;
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
  /** They depend on temperature; laws: strength or toughness. */
  bool has_warm_laws(const SceneInput &input);
  bool has_warm_friction(const SceneInput &input);
  inline bool has_warm_faces(const SceneInput &input)
  {
    return has_warm_laws(input) || has_warm_friction(input);
  }
  bool has_heated_sides(const SceneInput &input);
} // namespace nsfd
