#pragma once

#include "nsfd/mesh/discretization.h"

namespace nsfd
{
  /**
   * What `--check` prints: the mesh, the bodies, wave speeds, cells per
   * cohesive length, the step against the crossing time and against the bound
   * below which a step has one solution. Evaluates every expression of the
   * scene. @return exit_done, or exit_bad_input with every problem named.
   */
  template <int dim>
  int print_check(const SceneInput &input,
                  const dealii::Triangulation<dim, dim> &triangulation,
                  const Discretization<dim> &discretization,
                  double step,
                  const Communicator &communicator);
} // namespace nsfd
