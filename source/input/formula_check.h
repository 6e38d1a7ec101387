#pragma once

#include "core/communicator.h"

#include <string>
#include <vector>

namespace nsfd
{
  struct SceneInput;
  template <int dim>
  class Discretization;

  /**
   * Formulas that gave no finite number since the last call, with the place
   * and the time, one message each. Collective, the same on all ranks.
   */
  std::vector<std::string> bad_formulas(const Communicator &communicator);

  /**
   * Those among everything that was evaluated until now, and in loads, initial
   * values and given motions at the start and at the end of the run.
   * Collective.
   */
  template <int dim>
  std::vector<std::string>
  check_formulas(const SceneInput &input,
                 const Discretization<dim> &discretization,
                 const Communicator &communicator);
} // namespace nsfd
