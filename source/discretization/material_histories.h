#pragma once

#include <cstddef>
#include <vector>

namespace nsfd
{
  template <int dim>
  class Discretization;

  /** Of the cells in State::material_history: where each begins, and the end.
      Nothing but 0 for those whose materials have no history. */
  template <int dim>
  std::vector<std::size_t>
  first_histories(const Discretization<dim> &discretization);
} // namespace nsfd
