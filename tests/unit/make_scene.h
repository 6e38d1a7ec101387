#pragma once

#include "bodies/inelastic_bodies.h"
#include "bodies/moving_bodies.h"
#include "delassus/bonded.h"
#include "discretization/node_coordinates.h"
#include "input/read_scene.h"
#include "mesh/mesh_builder.h"
#include "nonsmooth/solver.h"
#include "nsfd/discretization/discretization.h"
#include "time_integration/linear_moreau_jean.h"
#include "time_integration/newton_moreau_jean.h"

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  namespace test
  {
    /** What a parameter file says, which must be right. */
    inline std::unique_ptr<SceneInput>
    make_input(const std::string &text,
               const std::vector<std::string> &overrides = {})
    {
      InputErrors errors;
      auto input = read_scene_text(text, "test.prm", overrides, errors);
      if (!input)
        throw std::invalid_argument(errors.report());
      return input;
    }

    /**
     * The parts of a run without its output, built from the text of a
     * parameter file as a run builds them. @p overrides are
     * `Section/name=value`.
     */
    template <int dim>
    class Scene
    {
    public:
      explicit Scene(const std::string &text,
                     const std::vector<std::string> &overrides = {})
          : input(make_input(text, overrides)), communicator(MPI_COMM_WORLD)
      {
        std::vector<std::string> problems, warnings;
        triangulation = build_mesh<dim>(*input, communicator.mpi(), problems);
        check(problems);
        groups = std::make_unique<MeshGroups<dim>>(*input, *triangulation);
        const auto materials = material_indices<dim>(
            *input, *groups, *triangulation, problems, warnings);
        check(problems);
        discretization = std::make_unique<Discretization<dim>>(
            communicator, *triangulation, *groups, materials, *input);

        time_step = input->time.step;
        if (input->time.step_kind != StepKind::time)
          time_step *= discretization->crossing_time();

        if (input->large_motion) {
          moving = std::make_unique<MovingBodies<dim>>(*input, *discretization,
                                                       communicator);
          dynamics = make_moving_dynamics<dim>(communicator, moving->bodies(),
                                               moving->points());
        } else if (input->has_history()) {
          inelastic = std::make_unique<InelasticBodies<dim>>(*discretization);
          dynamics = make_moving_dynamics<dim>(
              communicator, inelastic->bodies(), discretization->points());
        } else if (input->has_bonded_faces()) {
          const auto &bodies = discretization->bodies();
          const auto &points = discretization->points();
          auto joined = input->time.scheme == Scheme::symplectic
                            ? make_explicit_bonded_dynamics<dim>(communicator,
                                                                 bodies, points)
                            : make_bonded_dynamics<dim>(
                                  communicator, bodies, points,
                                  input->solver.linear_solver,
                                  node_coordinates(*discretization));
          bonded = joined.get();
          dynamics = std::move(joined);
        } else if (input->solver.path == "global")
          dynamics = make_sparse_dynamics<dim>(
              communicator, discretization->bodies(), discretization->points(),
              input->solver.linear_solver, node_coordinates(*discretization));
        else
          dynamics = make_elementwise_dynamics<dim>(
              communicator, discretization->bodies(), discretization->points());
        solver = SolverRegistry<dim>::instance().create(
            input->solver.method == "auto" ? "chain" : input->solver.method);
        if (moving)
          stepper = std::make_unique<NewtonMoreauJean<dim>>(
              *input, *discretization, *moving, *dynamics);
        else if (inelastic)
          stepper = std::make_unique<NewtonMoreauJean<dim>>(
              *input, *discretization, *inelastic, *dynamics);
        else
          stepper = std::make_unique<LinearMoreauJean<dim>>(
              *input, *discretization, *dynamics, *solver, bonded);
        dynamics->reinit(time_step, input->time.bulk_theta());
        state = stepper->initial_state();
        next = state;
      }

      /** One step of the length that the input names. */
      StepReport advance() { return advance(time_step); }

      /** @throws StepRejected */
      StepReport advance(const double h, const unsigned int attempts = 0)
      {
        const StepReport report = stepper->advance(
            state, h, next, SolverControl().idle_rounds << attempts);
        std::swap(state, next);
        return report;
      }

      /**
       * One step, halved as often as it takes to be solved, like a run does.
       * Returns its length.
       */
      double advance_halving()
      {
        double h = time_step;
        for (unsigned int halving = 0; halving < 10; ++halving, h /= 2.)
          try {
            advance(h, halving);
            return h;
          } catch (const StepRejected &) {
          }
        advance(h, 10);
        return h;
      }

      /** Kinetic, elastic and stored in the interfaces. */
      double energy() const
      {
        const EnergyLines &e = state.energy;
        return e.kinetic + e.elastic + e.cohesive;
      }

      std::unique_ptr<SceneInput> input;
      Communicator communicator;
      std::unique_ptr<dealii::Triangulation<dim>> triangulation;
      std::unique_ptr<MeshGroups<dim>> groups;
      std::unique_ptr<Discretization<dim>> discretization;
      std::unique_ptr<Dynamics<dim>> dynamics;
      BondedDynamics<dim> *bonded = nullptr;     ///< the same, or null
      std::unique_ptr<MovingBodies<dim>> moving; ///< of large motions, or null
      /// of small motions with materials that remember, or null
      std::unique_ptr<InelasticBodies<dim>> inelastic;
      std::unique_ptr<NonsmoothSolver<dim>> solver;
      std::unique_ptr<MoreauJean<dim>> stepper;
      double time_step = 0.;
      State state;
      State next; ///< after a step: the state before it

    private:
      static void check(const std::vector<std::string> &problems)
      {
        if (!problems.empty())
          throw std::invalid_argument(problems.front());
      }
    };
  } // namespace test
} // namespace nsfd
