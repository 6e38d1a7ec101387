#pragma once

namespace nsfd
{
  /** Unknowns up to which a sparse factor is cheaper than iterations. */
  template <int dim>
  constexpr long long largest_factor = dim == 2 ? 200000 : 15000;

  /** The same for a coarse matrix, whose factor serves longer. */
  template <int dim>
  constexpr long long largest_coarse_factor = dim == 2 ? 300000 : 15000;
} // namespace nsfd
