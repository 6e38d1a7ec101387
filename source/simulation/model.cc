#include "model.h"

#include "time_integration/linear_moreau_jean.h"
#include "time_integration/newton_moreau_jean.h"
#include "time_integration/stable_step.h"

#include "input/formula_check.h"

#include "core/cost.h"
#include "discretization/node_coordinates.h"
#include "discretization/point_factors.h"
#include "parameters/place_of.h"

#include <deal.II/grid/tria.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>

namespace nsfd
{
  void print_problems(const Communicator &communicator, const SceneInput &input,
                      const char *kind,
                      const std::vector<std::string> &problems)
  {
    if (!communicator.is_root())
      return;
    InputErrors errors;
    for (const auto &problem : problems) {
      if (kind == std::string("error"))
        errors.error(place_of(input.file, problem), problem);
      else if (kind == std::string("warning"))
        errors.warning(place_of(input.file, problem), problem);
      else
        std::cerr << input.file << ": " << kind << ": " << problem << "\n";
    }
    std::cerr << errors.report();
  }

  namespace
  {
    std::string after_semicolon(const std::string &sentence)
    {
      return sentence.empty() ? "" : "; " + sentence;
    }
  } // namespace

  template <int dim>
  bool Model<dim>::build(const SceneInput &input,
                         const Communicator &communicator)
  {
    std::vector<std::string> problems;
    build_mesh_parts(input, communicator, problems);
    if (problems.empty()) {
      find_unused_blocks(input, communicator, problems);
      find_impossible_bonds(input, communicator, problems);
      check_point_factors(input, *discretization, communicator, problems);
      build_control(input, problems);
      const auto bad = check_formulas(input, *discretization, communicator);
      problems.insert(problems.end(), bad.begin(), bad.end());
    }
    if (!problems.empty()) {
      print_problems(communicator, input, "error", problems);
      return false;
    }
    charge_memory("bodies and points");
    choose_path(input);
    build_dynamics(input, communicator);
    if (input.time.scheme == Scheme::symplectic)
      check_stability(input, communicator, problems);
    if (!problems.empty()) {
      print_problems(communicator, input, "error", problems);
      return false;
    }
    charge_memory("blocks of the bodies");
    method = input.time.scheme == Scheme::arkode ? "arkode"
             : input.solver.method == "auto"     ? "chain"
                                                 : input.solver.method;
    build_stepper(input);
    if (input.statics)
      quasi_static = std::make_unique<QuasiStatic<dim>>(input, communicator,
                                                        *discretization);
    return true;
  }

  template <int dim>
  void Model<dim>::build_stepper(const SceneInput &input)
  {
    solver = SolverRegistry<dim>::instance().create(
        input.solver.method == "auto" ? "chain" : input.solver.method);
    if (moving)
      stepper = std::make_unique<NewtonMoreauJean<dim>>(input, *discretization,
                                                        *moving, *dynamics);
    else if (inelastic)
      stepper = std::make_unique<NewtonMoreauJean<dim>>(input, *discretization,
                                                        *inelastic, *dynamics);
    else
      stepper = std::make_unique<LinearMoreauJean<dim>>(
          input, *discretization, *dynamics, *solver, bonded);
  }

  template <int dim>
  void Model<dim>::rebuild(const SceneInput &input,
                           const Communicator &communicator)
  {
    const auto stepper_counters = stepper->counters();
    const auto timings = stepper->timings();
    const auto dynamics_counters = dynamics->counters();
    stepper.reset();
    solver.reset();
    dynamics.reset();
    std::vector<std::string> problems, warnings;
    const auto materials = material_indices<dim>(input, *groups, *triangulation,
                                                 problems, warnings);
    *discretization = Discretization<dim>(communicator, *triangulation, *groups,
                                          materials, input);
    build_dynamics(input, communicator);
    dynamics->continue_counters(dynamics_counters);
    if (input.time.scheme == Scheme::symplectic) {
      const double limit = stable_limit(input, communicator,
                                        step_of_smallest_cells(communicator));
      control->limit(limit);
      control->set_ceiling(limit);
    }
    dynamics->reinit(control->step(), input.time.bulk_theta());
    build_stepper(input);
    stepper->continue_counters(timings, stepper_counters);
  }

  template <int dim>
  void Model<dim>::build_mesh_parts(const SceneInput &input,
                                    const Communicator &communicator,
                                    std::vector<std::string> &problems)
  {
    triangulation = build_mesh<dim>(input, communicator.mpi(), problems);
    if (!problems.empty())
      return;
    groups = std::make_unique<MeshGroups<dim>>(input, *triangulation);
    charge_memory("mesh");
    std::vector<std::string> warnings;
    const auto materials = material_indices<dim>(input, *groups, *triangulation,
                                                 problems, warnings);
    print_problems(communicator, input, "warning", warnings);
    if (!problems.empty())
      return;
    try {
      discretization = std::make_unique<Discretization<dim>>(
          communicator, *triangulation, *groups, materials, input);
    } catch (const std::runtime_error &error) {
      problems.push_back(error.what());
    }
  }

  /** Blocks that hold nowhere are mistakes. */
  template <int dim>
  void Model<dim>::find_unused_blocks(const SceneInput &input,
                                      const Communicator &communicator,
                                      std::vector<std::string> &problems) const
  {
    const auto check = [&](const std::string &name, const Where &where) {
      bool any = false;
      for (const auto &cell : triangulation->active_cell_iterators())
        if (cell->is_locally_owned())
          for (const unsigned int f : cell->face_indices())
            any = any || groups->holds_boundary_face(where, cell, f);
      if (!communicator.any(any))
        problems.push_back(name + ": no boundary face of the mesh is there" +
                           after_semicolon(groups->missing(where)));
    };
    for (const auto &boundary : input.boundaries)
      check("Boundary: " + boundary.name, boundary.where);
    for (const auto &obstacle : input.obstacles)
      check("Obstacle: " + obstacle.name, obstacle.where);
    if (!input.adaptivity) // refined cells have new faces
      warn_of_unused_interfaces(input, communicator);
  }

  /** As of materials that own no cell: of faces, and of broken ones. */
  template <int dim>
  void
  Model<dim>::warn_of_unused_interfaces(const SceneInput &input,
                                        const Communicator &communicator) const
  {
    const auto &origins = discretization->origins();
    const std::size_t n_blocks = input.interfaces.size();
    std::vector<char> has_faces(n_blocks, 0), has_broken(n_blocks, 0);
    for (std::size_t i = 0; i < discretization->points().n_owned; ++i) {
      if (origins[i].kind != PointOrigin::Kind::interface)
        continue;
      const InterfaceInput &block = input.interfaces[origins[i].block];
      has_faces[origins[i].block] = 1;
      if (block.has_broken && !has_broken[origins[i].block])
        has_broken[origins[i].block] =
            block.broken.at(discretization->position(i)) != 0.;
    }
    // a mesh of single cells has no faces for anyone
    const bool any_faces =
        communicator.any(std::any_of(has_faces.begin(), has_faces.end(),
                                     [](const char has) { return has != 0; }));
    std::vector<std::string> warnings;
    for (std::size_t b = 0; b < n_blocks; ++b) {
      const InterfaceInput &block = input.interfaces[b];
      const std::string name = "Interface: " + block.name;
      if (!any_faces && block.where.kind == Where::Kind::all)
        continue;
      if (!communicator.any(has_faces[b]))
        warnings.push_back(name +
                           ": no face; `where` holds nowhere, or only "
                           "where an earlier section does" +
                           after_semicolon(groups->missing(block.where)));
      else if (block.has_broken && !communicator.any(has_broken[b]))
        warnings.push_back(name + "/broken: no point of its faces is broken");
    }
    print_problems(communicator, input, "warning", warnings);
  }

  /** Bonds act through the bulk of cells, and rigid ones have none. */
  template <int dim>
  void
  Model<dim>::find_impossible_bonds(const SceneInput &input,
                                    const Communicator &communicator,
                                    std::vector<std::string> &problems) const
  {
    const auto &points = discretization->points();
    const auto is_rigid = [&](const int body) {
      return body >= 0 &&
             input.materials[discretization->material_of(unsigned(body))].rigid;
    };
    std::vector<char> found(input.interfaces.size(), 0);
    for (const auto &face : points.faces) {
      const PointOrigin origin = discretization->origins()[face.first];
      if (face.count > 0 && origin.kind == PointOrigin::Kind::interface &&
          input.interfaces[origin.block].intact == IntactFaces::bonded &&
          is_rigid(face.bodies[0]) && is_rigid(face.bodies[1]))
        found[origin.block] = 1;
    }
    for (std::size_t b = 0; b < input.interfaces.size(); ++b)
      if (communicator.any(found[b])) {
        const InterfaceInput &block = input.interfaces[b];
        problems.push_back(fmt::format(
            "Interface: {}/{}: bonded faces join cells through what they are "
            "made of, and two rigid cells meet here: write before it an "
            "Interface block for the faces between rigid cells, with {}",
            block.name, block.law ? "intact faces" : "law",
            block.law ? "intact faces = rigid" : "law = rigid"));
      }
  }

  template <int dim>
  void Model<dim>::build_control(const SceneInput &input,
                                 std::vector<std::string> &problems)
  {
    if (input.time.step_kind != StepKind::time &&
        discretization->crossing_time() == 0.) {
      problems.push_back("Time/step: all bodies are rigid, there is no "
                         "crossing time; write the step as a time");
      return;
    }
    const bool quasi_static = input.statics && input.statics->steps;
    // more are a slip of the pen, and are counted in 32 bits
    constexpr double most_steps = 1e9;
    const auto demand_fewer = [&](const char *entry, const double duration,
                                  const double step) {
      if (duration / step <= most_steps)
        return true;
      problems.push_back(fmt::format(
          "Time/{}: {:.4g} s in steps of {:.4g} s are {:.2g} steps, more than "
          "{:g}: write a shorter time or longer steps",
          entry, duration, step, duration / step, most_steps));
      return false;
    };
    const double until = input.statics ? input.statics->until : 0.;
    if (quasi_static && !demand_fewer("step", until, input.statics->step))
      return;
    if (input.may_move() &&
        !demand_fewer("end", input.time.end - until, dynamic_step(input)))
      return;
    control = quasi_static
                  ? std::make_unique<StepControl>(input.statics->until,
                                                  input.statics->step,
                                                  input.time.maximum_halvings)
                  : dynamic_control(input, 0.);
  }

  /** All bonds that the scene may have. */
  template <int dim>
  void Model<dim>::join_all(const SceneInput &input)
  {
    const auto &origins = discretization->origins();
    std::vector<std::uint8_t> joined(origins.size(), 0);
    for (std::size_t i = 0; i < origins.size(); ++i)
      joined[i] =
          origins[i].kind == PointOrigin::Kind::interface &&
          input.interfaces[origins[i].block].intact == IntactFaces::bonded;
    bonded->set_bonds(joined);
  }

  /** Bodies, and bonds between them, are explicit in the symplectic scheme. */
  template <int dim>
  double Model<dim>::stable_limit(const SceneInput &input,
                                  const Communicator &communicator,
                                  const double enough)
  {
    if (!bonded)
      return communicator.min(stable_step(discretization->bodies()));
    join_all(input);
    dynamics->reinit(control->step(), 0.);
    return stable_step(*dynamics, enough);
  }

  /** The base step, halved as often as the smallest cells. */
  template <int dim>
  double
  Model<dim>::step_of_smallest_cells(const Communicator &communicator) const
  {
    int level = 0;
    for (const auto &cell : triangulation->active_cell_iterators())
      if (cell->is_locally_owned())
        level = std::max(level, cell->level());
    return std::ldexp(control->base_step(), -int(communicator.max(level)));
  }

  template <int dim>
  void Model<dim>::check_stability(const SceneInput &input,
                                   const Communicator &communicator,
                                   std::vector<std::string> &problems)
  {
    const double limit = stable_limit(input, communicator,
                                      std::numeric_limits<double>::infinity());
    if (dynamic_step(input) > limit)
      problems.push_back(fmt::format(
          "Time/step is {:.4g} s, and the symplectic scheme is stable up to "
          "{:.4g} s: write at most `{:.3f} crossings`",
          dynamic_step(input), limit,
          0.999 * limit / discretization->crossing_time()));
  }

  template <int dim>
  double Model<dim>::dynamic_step(const SceneInput &input) const
  {
    return input.time.step * (input.time.step_kind == StepKind::time
                                  ? 1.
                                  : discretization->crossing_time());
  }

  template <int dim>
  std::unique_ptr<StepControl>
  Model<dim>::dynamic_control(const SceneInput &input, const double start) const
  {
    return std::make_unique<StepControl>(input.time.end, dynamic_step(input),
                                         input.time.maximum_halvings, start);
  }

  /** Short steps: face blocks; long ones: a global matrix. */
  template <int dim>
  void Model<dim>::choose_path(const SceneInput &input)
  {
    const double crossing = discretization->crossing_time();
    if (input.iterates())
      path = "element-wise";
    else if (input.has_bonded_faces())
      path =
          input.time.scheme == Scheme::symplectic ? "element-wise" : "global";
    else if (input.solver.path != "auto")
      path = input.solver.path;
    else
      path = crossing > 0. && dynamic_step(input) > 5. * crossing
                 ? "global"
                 : "element-wise";
  }

  template <int dim>
  void Model<dim>::build_dynamics(const SceneInput &input,
                                  const Communicator &communicator)
  {
    const auto &bodies = discretization->bodies();
    const auto &points = discretization->points();
    if (input.large_motion) {
      moving = std::make_unique<MovingBodies<dim>>(input, *discretization,
                                                   communicator);
      dynamics = make_moving_dynamics<dim>(communicator, moving->bodies(),
                                           moving->points());
      return;
    }
    if (input.has_history()) {
      inelastic = std::make_unique<InelasticBodies<dim>>(*discretization);
      dynamics =
          make_moving_dynamics<dim>(communicator, inelastic->bodies(), points);
      return;
    }
    if (input.has_bonded_faces() && input.time.scheme == Scheme::symplectic) {
      auto joined =
          make_explicit_bonded_dynamics<dim>(communicator, bodies, points);
      bonded = joined.get();
      dynamics = std::move(joined);
      return;
    }
    if (input.has_bonded_faces()) {
      auto joined = make_bonded_dynamics<dim>(
          communicator, bodies, points, input.solver.linear_solver,
          node_coordinates(*discretization));
      bonded = joined.get();
      dynamics = std::move(joined);
      return;
    }
    if (path == "global")
      dynamics = make_sparse_dynamics<dim>(communicator, bodies, points,
                                           input.solver.linear_solver,
                                           node_coordinates(*discretization));
    else
      dynamics = make_elementwise_dynamics<dim>(communicator, bodies, points);
  }

  template struct Model<2>;
  template struct Model<3>;
} // namespace nsfd
