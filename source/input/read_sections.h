#pragma once

#include "nsfd/parameters/initial_expression.h"
#include "nsfd/parameters/section_reader.h"
#include "nsfd/scene/scene_input.h"
#include "parameters/input_errors.h"
#include "parameters/parameter_file.h"

#include <array>
#include <string>
#include <vector>

// The parts of read_scene(), in the order in which they run: a part may look
// at what the parts before it have put into the scene.

namespace nsfd
{
  /** Section `Constants`: numbers for all the values that follow. */
  void read_constants(ParameterFile &file, InputErrors &errors);

  /**
   * Entry `plug-ins` at the top: what @p name needs. False, and reported with
   * the line to type behind @p command, if one is not loaded: what it would
   * bring is then unknown, and nothing more should be read.
   */
  bool read_plug_ins(ParameterFile &file, InputErrors &errors,
                     const std::string &command, const std::string &name);

  /** did_you_mean() for a name that a plug-in may bring. */
  std::string advice_on_name(const std::string &word,
                             const std::vector<std::string> &known,
                             const std::string &otherwise);

  /** The name of a registered part; the default, and reported, if it is none.
   */
  std::string read_registered_name(SectionReader &reader,
                                   const std::string &entry,
                                   const std::string &default_text,
                                   const std::vector<std::string> &known);

  /** Mesh, the bodies of a mesh of type `bodies`, Discretization. */
  void read_mesh(ParameterFile &file, InputErrors &errors, SceneInput &scene);
  void read_discretization(ParameterFile &file, InputErrors &errors,
                           SceneInput &scene);

  /**
   * The scheme of section `Time` where other sections have defaults of their
   * own for it; read_time() reads it, and reports what is wrong with it.
   */
  void look_at_scheme(const ParameterFile &file, SceneInput &scene);

  /** Entries `initial stress xx` and so on; none may be given. */
  StressInput read_initial_stress(SectionReader &reader,
                                  const SceneInput &scene,
                                  const std::string &text);
  /** The same of an Interface block. */
  StressInput read_initial_traction(SectionReader &reader,
                                    const SceneInput &scene);
  /** Those of them that the file gives are reported, with the reason. */
  void refuse_initial_stress(SectionReader &reader, const std::string &reason);

  void read_materials(ParameterFile &file, InputErrors &errors,
                      SceneInput &scene);
  void read_interfaces(ParameterFile &file, InputErrors &errors,
                       SceneInput &scene);

  /**
   * A registered law with the entries that it asks for; null, and reported, if
   * they do not make one.
   */
  std::shared_ptr<const CohesiveLaw> read_cohesive_law(SectionReader &reader,
                                                       const std::string &name);

  /** s of kappa = (1 - beta)^s; null: no law. */
  double read_friction_exponent(SectionReader &reader, const CohesiveLaw *law);

  /** mu. */
  double read_friction(SectionReader &reader);
  bool read_plateau(SectionReader &reader, const CohesiveLaw *law,
                    const std::string &law_name);
  SlidingInput read_sliding(SectionReader &reader, double friction);

  /** k of Archard's law, 1/Pa. */
  double read_wear(SectionReader &reader);

  /** Boundary and Obstacle blocks, Loads. */
  void read_boundaries(ParameterFile &file, InputErrors &errors,
                       SceneInput &scene);
  void read_obstacles(ParameterFile &file, InputErrors &errors,
                      SceneInput &scene);
  void read_loads(ParameterFile &file, InputErrors &errors, SceneInput &scene);

  /** What Boundary blocks do when a crack begins: after all laws are known. */
  void read_events(ParameterFile &file, InputErrors &errors, SceneInput &scene);
  /** A sentence; empty if something may break. */
  std::string why_nothing_breaks(const SceneInput &scene);

  /** There are materials, and all of them are rigid. */
  bool no_body_deforms(const SceneInput &scene);

  /** Contact and Pin blocks, of scenes with large motions only. */
  void read_contacts(ParameterFile &file, InputErrors &errors,
                     SceneInput &scene);
  void read_pins(ParameterFile &file, InputErrors &errors, SceneInput &scene);

  /** Time, Solver, Output, Verification. */
  void read_time(ParameterFile &file, InputErrors &errors, SceneInput &scene);
  void read_solver(ParameterFile &file, InputErrors &errors, SceneInput &scene);
  void read_output(ParameterFile &file, InputErrors &errors, SceneInput &scene);
  void read_verification(ParameterFile &file, InputErrors &errors,
                         SceneInput &scene);

  /** Adaptivity and its Indicator blocks. */
  void read_adaptivity(ParameterFile &file, InputErrors &errors,
                       SceneInput &scene);

  /** A mesh that the memory of this machine cannot hold is an error. */
  void check_memory(ParameterFile &file, InputErrors &errors,
                    const SceneInput &scene);

  /** Of a scene with plane = axisymmetric, what it cannot have: after all has
      been read. */
  void refuse_axisymmetric(ParameterFile &file, InputErrors &errors,
                           const SceneInput &scene);

  /** Observable blocks. */
  void read_observables(ParameterFile &file, InputErrors &errors,
                        SceneInput &scene);

  /** What a `where` picks. */
  enum class WhereUse { cells, interior_faces, boundary_faces };

  /**
   * Read an entry `where`; an empty @p default_text means that it must be
   * given. Needs the mesh and the materials (for interior faces) of @p scene.
   */
  Where read_where(SectionReader &reader, const std::string &default_text,
                   WhereUse use, const SceneInput &scene,
                   const std::string &text);

  /** Report a name that no Material block has, at the entry @p entry. */
  void check_material(SectionReader &reader, const std::string &entry,
                      const std::string &name, const SceneInput &scene);

  /**
   * "[a, b]" or "a, b": two materials that exist. @p value is the whole value
   * of @p entry that @p names ends, and @p example a right one. Empty, and
   * reported, if they are not two.
   */
  std::array<std::string, 2>
  read_two_materials(SectionReader &reader, const std::string &entry,
                     const std::string &value, std::string names,
                     const std::string &example, const SceneInput &scene);

  /**
   * Where a Boundary block is that does not say it: the side, the group of the
   * mesh or the body that has its name; empty if there is none.
   */
  std::string where_by_name(const std::string &name, const SceneInput &scene);

  /** An expression that may be left out. */
  std::optional<Expression> read_optional_expression(SectionReader &reader,
                                                     const std::string &name,
                                                     Unit unit,
                                                     const std::string &text);

  /** "model = j2 plastic" where a material keeps its strains, else "". */
  std::string history_dependent_model(const SceneInput &scene);

  /** True if the cells are triangles or tetrahedra. */
  bool has_simplices(const SceneInput &scene);

  /** True if material and boundary ids mean something: a generator's mesh. */
  bool has_numbered_groups(const SceneInput &scene);

  /** "velocity z" for ("velocity", 2). */
  std::string component_name(const std::string &name, unsigned int component);

  /** Report those of the names whose component z has no place in 2D. */
  void refuse_third_component(SectionReader &reader,
                              const std::vector<std::string> &names,
                              const SceneInput &scene);

  /** What a file may name besides what is registered, with its text. */
  struct NamedText {
    std::string name, text;
  };
  std::vector<NamedText> known_plain_laws();
  std::vector<NamedText> known_bulk_models();
  std::vector<NamedText> known_time_schemes();

  /** `auto` and the registered ones. */
  std::vector<NamedText> known_solvers();
} // namespace nsfd
