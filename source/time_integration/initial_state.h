#pragma once

#include "delassus/joined_delassus.h"
#include "discretization/discretization.h"
#include "nonsmooth/one_step_problem.h"
#include "state/state.h"

namespace nsfd
{
  struct SceneInput;

  /**
   * State at t = 0: fields of the materials, gaps to obstacles, intact and
   * broken points, stored energies. @p problem is the constant data of the
   * points. Its bonds are set in @p bonded (null: there are none).
   * Collective.
   */
  template <int dim>
  State initial_state(const SceneInput &input,
                      const Discretization<dim> &discretization,
                      const DelassusOperator<dim> &delassus,
                      const OneStepProblem<dim> &problem,
                      JoinedDelassus<dim> *bonded);

  /**
   * Distance of a boundary point from the half space it may touch, m; 0 for
   * points that face no obstacle.
   */
  template <int dim>
  double initial_gap(const SceneInput &input,
                     const Discretization<dim> &discretization, std::size_t i);

  /**
   * Kinetic, elastic and cohesive energy of a state whose bonds are those of
   * @p delassus. Collective.
   */
  template <int dim>
  void set_energies(const DelassusOperator<dim> &delassus,
                    const OneStepProblem<dim> &problem, State &state);

  /**
   * Bodies that share nodes move together from now on; the jumps of @p state
   * follow. Collective.
   */
  template <int dim>
  void join_motion(JoinedDelassus<dim> &bonded, State &state);

  /** Displacements and velocities of the bodies alone. */
  template <int dim>
  State initial_motion(const SceneInput &input,
                       const Discretization<dim> &discretization);

  /**
   * What the points are and keep at t = 0, from the jumps of @p state; gaps
   * of obstacles go into these.
   */
  template <int dim>
  void set_points(const SceneInput &input,
                  const Discretization<dim> &discretization,
                  const OneStepProblem<dim> &problem, State &state);

  /**
   * Springs that carry an initial stress are open, or closed, by what this
   * takes: added to the jumps of @p state.
   * @throws std::runtime_error with a sentence for the user, on all ranks,
   * where a law cannot carry it. Collective.
   */
  template <int dim>
  void add_initial_jumps(const SceneInput &input,
                         const Discretization<dim> &discretization,
                         const OneStepProblem<dim> &problem,
                         const Communicator &communicator, State &state);

  /** Of springs and cohesion at the jumps of @p state, in J. Collective. */
  template <int dim>
  double stored_in_points(const Communicator &communicator,
                          const OneStepProblem<dim> &problem,
                          const State &state);

  /** From the energies of @p state on. */
  void begin_balance(State &state);
} // namespace nsfd
