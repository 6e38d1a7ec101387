#pragma once

#include "model.h"

namespace nsfd
{
  /**
   * Boundaries and obstacles that hold nowhere, as @p problems; interfaces that
   * do, as warnings on standard error. Collective.
   */
  template <int dim>
  void find_unused_blocks(const SceneInput &input, const Model<dim> &model,
                          const Communicator &communicator,
                          std::vector<std::string> &problems);
} // namespace nsfd
