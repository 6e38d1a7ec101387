#pragma once

namespace nsfd
{
  /** Unknowns up to which a sparse factor is cheaper than iterations. */
  template <int dim>
  constexpr long long largest_factor = dim == 2 ? 200000 : 15000;

  /**
   * The same for bodies that share nodes. Measured on blocks of hexes that are
   * pulled apart: a factor serves some six solutions, and costs, with one of
   * them, four of multigrid at 35 000 unknowns and five at 90 000. A factor of
   * short steps serves hundreds: 27 000 hexes at a Courant number of 1 take
   * 0.9 s per step with it, and 6 s with multigrid.
   */
  template <int dim>
  constexpr long long largest_joined_factor = dim == 2 ? 200000 : 100000;

  /** The same for a coarse matrix, whose factor serves longer. */
  template <int dim>
  constexpr long long largest_coarse_factor = dim == 2 ? 300000 : 15000;
} // namespace nsfd
