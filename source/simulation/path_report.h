#pragma once

#include "model.h"

namespace nsfd
{
  /**
   * On standard output, of `--check`: which integrator takes the steps, which
   * linear algebra and solver, why, and settings that cost less and give the
   * same. Collective.
   */
  template <int dim>
  void print_path(const SceneInput &input, const Model<dim> &model,
                  const Communicator &communicator);
} // namespace nsfd
