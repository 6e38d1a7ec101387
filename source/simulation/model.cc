#include "model.h"

#include "adaptivity/initial_mesh.h"
#include "model_checks.h"
#include "print_problems.h"
#include "time_integration/time_scheme.h"

#include "core/cost.h"
#include "discretization/fixed_faces.h"
#include "discretization/node_coordinates.h"
#include "discretization/point_factors.h"
#include "input/formula_check.h"
#include "nonsmooth/solver_name.h"

#include <deal.II/grid/tria.h>

#include <fmt/format.h>

namespace nsfd
{
  namespace
  {
    /** Of small motions, for bodies without bonds between them. */
    template <int dim>
    std::unique_ptr<DelassusOperator<dim>> make_linear_delassus(
        const SceneInput &input, const Communicator &communicator,
        const Discretization<dim> &discretization, const bool assembled)
    {
      const auto &bodies = discretization.bodies();
      const auto &points = discretization.points();
      if (assembled)
        return make_assembled_delassus<dim>(communicator, bodies, points,
                                            input.solver.linear_solver,
                                            node_coordinates(discretization));
      return make_local_delassus<dim>(communicator, bodies, points);
    }

    template <int dim>
    std::unique_ptr<NonsmoothSolver<dim>> make_solver(const SceneInput &input,
                                                      const char *automatic)
    {
      return SolverRegistry<dim>::instance().create(
          solver_name(input.solver.method, automatic));
    }
  } // namespace

  template <int dim>
  std::vector<std::string> Model<dim>::build(const SceneInput &input,
                                             const Communicator &communicator)
  {
    std::vector<std::string> problems;
    if (input.follows_path() && communicator.size() > 1)
      problems.push_back(
          fmt::format("Time/at solution jump = arc length runs on one rank, "
                      "not on {}: run it without mpirun, or write relax, stop "
                      "or dynamic",
                      communicator.size()));
    build_mesh_parts(input, communicator, problems);
    if (problems.empty()) {
      find_unused_blocks(input, *this, communicator, problems);
      check_point_factors(input, *discretization, communicator, problems);
      build_control(input, communicator, problems);
      const auto bad = check_formulas(input, *discretization, communicator);
      problems.insert(problems.end(), bad.begin(), bad.end());
    }
    if (!problems.empty())
      return problems;
    charge_memory("bodies and points");
    choose_path(input);
    if (!input.time.scheme.at_nodes) {
      build_delassus(input, communicator);
      if (input.time.scheme.explicit_forces) {
        explicit_limit = stable_limit(input, communicator);
        control = dynamic_control(input, 0.);
        check_stability(input, communicator, problems);
        keep_longest_step();
      }
      if (!problems.empty())
        return problems;
      charge_memory("blocks of the bodies");
    }
    build_integrators(input, communicator, problems);
    if (!problems.empty())
      return problems;
    if (input.time.scheme.at_nodes)
      check_stability(input, communicator, problems);
    else if (input.statics) // explicit steps find theirs by themselves
      build_equilibria(input, communicator);
    return problems;
  }

  /** With matrices and a solver of their own. */
  template <int dim>
  void Model<dim>::build_equilibria(const SceneInput &input,
                                    const Communicator &communicator)
  {
    // interior points know the matrices of single bodies only
    const bool any_solver = input.solver.method != "interior point";
    if (input.equilibria_at_nodes)
      equilibria = std::make_unique<QuasiStatic<dim>>(
          input, *discretization,
          make_joined_delassus<dim>(
              communicator, discretization->bodies(), discretization->points(),
              input.solver.linear_solver, node_coordinates(*discretization),
              fixed_faces(*discretization)),
          any_solver ? make_solver<dim>(input, "cascade")
                     : SolverRegistry<dim>::instance().create("cascade"));
    else
      equilibria = std::make_unique<QuasiStatic<dim>>(
          input, *discretization,
          make_linear_delassus(input, communicator, *discretization,
                               input.solver.path != "local"),
          make_solver<dim>(input, "dual newton"));
  }

  /** Cells of other ranks around those of this one; null on one rank. */
  template <int dim>
  std::unique_ptr<const GhostLayer<dim>>
  Model<dim>::ghost_layer(const SceneInput &input,
                          const Communicator &communicator)
  {
    if (communicator.size() == 1)
      return nullptr;
    if (input.has_body_table())
      return whole_mesh(input, communicator);
    std::vector<std::string> problems, warnings; // as before
    const auto materials =
        cell_materials.empty()
            ? material_indices<dim>(input, *groups, *triangulation, problems,
                                    warnings)
            : cell_materials;
    return std::make_unique<const GhostLayer<dim>>(
        communicator, *discretization,
        std::make_unique<const Discretization<dim>>(
            communicator, *triangulation, *groups, materials, input,
            CellSet::with_ghosts));
  }

  /** All cells, as one rank alone has them. */
  template <int dim>
  std::unique_ptr<const GhostLayer<dim>>
  Model<dim>::whole_mesh(const SceneInput &input,
                         const Communicator &communicator) const
  {
    std::vector<std::string> problems, warnings; // as those of the ranks
    const auto mesh = build_mesh<dim>(input, MPI_COMM_SELF, problems);
    const MeshGroups<dim> all_groups(input, *mesh);
    const auto materials =
        material_indices<dim>(input, all_groups, *mesh, problems, warnings);
    const auto &cell_of = discretization->body_table().cell_of_global;
    std::vector<unsigned long long> numbers(cell_of.size());
    for (std::size_t number = 0; number < cell_of.size(); ++number)
      numbers[cell_of[number]] = number;
    return std::make_unique<const GhostLayer<dim>>(
        communicator, *discretization,
        std::make_unique<const Discretization<dim>>(
            Communicator(MPI_COMM_SELF), *mesh, all_groups, materials, input),
        numbers);
  }

  /** What takes the steps, as the scheme says. */
  template <int dim>
  void Model<dim>::build_integrators(const SceneInput &input,
                                     const Communicator &communicator,
                                     std::vector<std::string> &problems)
  {
    const auto scheme = find_time_scheme(input.time.scheme_name);
    method = scheme->solver();
    if (method.empty())
      method = solver_name(input.solver.method, "cascade");
    if (delassus && !moving && !inelastic)
      solver = make_solver<dim>(input, "cascade");
    try {
      auto built = scheme->template build<dim>(
          {input, communicator, *discretization, delassus.get(), bonded,
           moving.get(), inelastic.get(), solver.get(),
           [&] { return ghost_layer(input, communicator); }});
      stepper = std::move(built.stepper);
      other = std::move(built.other);
    } catch (const std::runtime_error &error) {
      problems.push_back(error.what());
      return;
    }
    leapfrog = dynamic_cast<Leapfrog<dim> *>(other.get());
    if (!leapfrog)
      return;
    charge_memory("blocks of the bodies");
    // what frequencies of free cells, squared, are multiplied with at most
    const double share =
        communicator.max(leapfrog->parts().hanging.mass_share());
    if (share > 1.) { // masses of nodes that follow others lie differently
      explicit_limit /= share;
      control = dynamic_control(input, 0.);
    }
  }

  template <int dim>
  State Model<dim>::initial_state() const
  {
    return leapfrog ? leapfrog->initial_state() : stepper->initial_state();
  }

  template <int dim>
  const OneStepProblem<dim> &Model<dim>::points() const
  {
    return leapfrog  ? leapfrog->parts().constants
           : stepper ? stepper->problem()
                     : equilibria->search().points();
  }

  template <int dim>
  std::vector<TimeIntegrator<dim> *> Model<dim>::integrators() const
  {
    std::vector<TimeIntegrator<dim> *> all;
    if (equilibria)
      all.push_back(equilibria.get());
    if (other || stepper)
      all.push_back(other ? other.get() : stepper.get());
    return all;
  }

  template <int dim>
  void Model<dim>::forget_dynamics()
  {
    stepper.reset();
    solver.reset();
    bonded = nullptr;
    delassus.reset();
  }

  template <int dim>
  void Model<dim>::rebuild(const SceneInput &input,
                           const Communicator &communicator)
  {
    const auto stepper_counters = stepper->counters();
    const auto timings = stepper->timings();
    const auto delassus_counters = delassus->counters();
    stepper.reset();
    solver.reset();
    delassus.reset();
    std::vector<std::string> problems, warnings;
    const auto materials = material_indices<dim>(input, *groups, *triangulation,
                                                 problems, warnings);
    *discretization = Discretization<dim>(communicator, *triangulation, *groups,
                                          materials, input);
    build_delassus(input, communicator);
    delassus->continue_counters(delassus_counters);
    if (input.time.scheme.explicit_forces) {
      explicit_limit = stable_limit(input, communicator);
      control->limit(explicit_limit);
      control->set_ceiling(explicit_limit);
      keep_longest_step();
    }
    delassus->reinit(control->step(), input.time.bulk_theta());
    build_integrators(input, communicator, problems);
    stepper->continue_counters(timings, stepper_counters);
  }

  template <int dim>
  void Model<dim>::rebuild_joined(const SceneInput &input,
                                  const Communicator &communicator,
                                  const std::vector<unsigned int> &materials)
  {
    cell_materials = materials;
    *discretization = Discretization<dim>(communicator, *triangulation, *groups,
                                          materials, input);
    renew_leapfrog(input, communicator);
  }

  template <int dim>
  void Model<dim>::renew_leapfrog(const SceneInput &input,
                                  const Communicator &communicator)
  {
    const auto before = std::move(other); // its counters
    std::vector<std::string> problems;
    build_integrators(input, communicator, problems);
    if (!problems.empty())
      throw std::runtime_error(problems.front());
    leapfrog->continue_counters(dynamic_cast<const Leapfrog<dim> &>(*before));
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
    if (input.adaptivity && !input.mesh_changes())
      refine_by_place(input, *triangulation);
    charge_memory("mesh");
    std::vector<std::string> warnings;
    const auto materials = material_indices<dim>(input, *groups, *triangulation,
                                                 problems, warnings);
    if (warns)
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

  /** Short steps: face blocks; long ones: an assembled matrix. */
  template <int dim>
  void Model<dim>::choose_path(const SceneInput &input)
  {
    const double crossing = discretization->crossing_time();
    if (input.iterates())
      path = "local";
    else if (input.time.scheme.at_nodes)
      path = "nodes";
    else if (input.has_bonded_faces())
      path = "assembled";
    else if (input.solver.path != "auto")
      path = input.solver.path;
    else
      path = crossing > 0. && dynamic_step(input) > 5. * crossing ? "assembled"
                                                                  : "local";
  }

  template <int dim>
  void Model<dim>::build_delassus(const SceneInput &input,
                                  const Communicator &communicator)
  {
    const auto &bodies = discretization->bodies();
    const auto &points = discretization->points();
    if (input.large_motion) {
      moving = std::make_unique<MovingBodies<dim>>(input, *discretization,
                                                   communicator);
      delassus = make_moving_delassus<dim>(communicator, moving->bodies(),
                                           moving->points());
      return;
    }
    if (input.has_history()) {
      inelastic = std::make_unique<InelasticBodies<dim>>(*discretization);
      delassus =
          make_moving_delassus<dim>(communicator, inelastic->bodies(), points);
      return;
    }
    if (input.has_bonded_faces()) {
      auto joined = make_joined_delassus<dim>(
          communicator, bodies, points, input.solver.linear_solver,
          node_coordinates(*discretization), fixed_faces(*discretization));
      bonded = joined.get();
      delassus = std::move(joined);
      return;
    }
    delassus = make_linear_delassus(input, communicator, *discretization,
                                    path == "assembled");
  }

  template struct Model<2>;
  template struct Model<3>;
} // namespace nsfd
