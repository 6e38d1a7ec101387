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

  /**
   * Unknowns of bodies that share nodes from which on short steps are solved by
   * conjugate gradients with blocks on the diagonal: 25 iterations at a Courant
   * number of 1. Measured there: 27 000 hexes 0.15 s per step, with a factor
   * 0.6 s; 40 000 quadrilaterals, nothing open, 39 ms per solution, with a
   * factor 27 ms; but 1712 quadrilaterals that break 8 ms per step, with
   * factors 28 ms, and 2866 triangles 10 and 60 ms.
   */
  constexpr long long smallest_of_iterations = 1000;
  /**
   * What makes a step short: the largest entry of f K over that of M on the
   * diagonal, which is 1.0 to 1.3 (Courant number)^2 for squares and cubes of
   * degree 1. Iterations grow like the Courant number: 50 at 2, where a factor
   * would do as well, and some 150 at 5, where multigrid does.
   */
  constexpr double stiffest_beside_factor = 5., stiffest_of_iterations = 30.;

  /** The same for a coarse matrix, whose factor serves longer. */
  template <int dim>
  constexpr long long largest_coarse_factor = dim == 2 ? 300000 : 15000;
} // namespace nsfd
