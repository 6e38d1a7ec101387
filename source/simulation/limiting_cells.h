#pragma once

#include "discretization/discretization.h"

#include <string>

namespace nsfd
{
  /**
   * Which cells decide the stable step of `scheme = explicit`: how many are
   * within 10 % of the shortest one, where the worst is, what it would be
   * without the worst 1 % of them, and what to do about it; lines of `--check`,
   * on the first rank. Collective.
   */
  template <int dim>
  std::string limiting_cells(const SceneInput &input,
                             const Discretization<dim> &discretization,
                             const Communicator &communicator);
} // namespace nsfd
