#pragma once

#include "discretization/discretization.h"

#include <string>

namespace nsfd
{
  /**
   * How far an initial stress is from equilibrium with the loads of t = 0 where
   * no motion is prescribed: the largest force that is left over at a node,
   * over the forces of the cells in it and over the largest such forces of all
   * nodes; and on how many points of each Interface block the initial traction
   * is beyond what they carry. Lines of `--check` on the first rank; empty: the
   * scene has none. Collective.
   */
  template <int dim>
  std::string initial_stress_report(const SceneInput &input,
                                    const Discretization<dim> &discretization,
                                    const Communicator &communicator);
} // namespace nsfd
