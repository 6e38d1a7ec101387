#pragma once

#include "nonsmooth/point_law.h"
#include "state/state.h"

#include <vector>

namespace nsfd
{
  /** Where the rounds from one equilibrium to the next one stand. */
  template <int dim>
  struct LoadStepIterate {
    const State *old = nullptr; ///< the equilibrium at the start
    /// the iterate as the start of a round; after it, where it has come to
    State at;
    double h = 0.;             ///< of the last round, s
    std::vector<double> force; ///< r of the last round in N
    /// extrinsic points that got their law in this step, or have been opened
    std::vector<char> activated;
    static constexpr char lets_go = 1, opened = 2;
    std::vector<LocalSolution<dim>> solutions; ///< of the last round

    /** It holds its two sides together until it reaches its strength. */
    bool starts_joined(const std::size_t point) const
    {
      return old->kind[point] == PointKind::rigid ||
             old->kind[point] == PointKind::bonded;
    }
  };
} // namespace nsfd
