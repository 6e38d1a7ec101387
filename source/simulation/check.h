#pragma once

#include "delassus/delassus_operator.h"
#include "discretization/discretization.h"

namespace nsfd
{
  template <int dim>
  class MoreauJean;

  /**
   * What `--check` prints: the mesh, the bodies, wave speeds, the step, and
   * advice for each Interface block (`advice.h`): points per cohesive length,
   * added compliance, jumps of the solution, steps with one solution, each
   * with the entry to change. Evaluates every expression of the scene.
   * @return exit_done, or exit_bad_input with every problem named.
   */
  template <int dim>
  int print_check(const SceneInput &input,
                  const dealii::Triangulation<dim, dim> &triangulation,
                  const Discretization<dim> &discretization,
                  const MoreauJean<dim> *stepper,
                  DelassusOperator<dim> *delassus, double step,
                  const Communicator &communicator);
} // namespace nsfd
