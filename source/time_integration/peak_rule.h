#pragma once

#include "nonsmooth/point_law.h"

namespace nsfd
{
  /** The envelope of one point: T(d) = a T_0(l d), see CohesiveLaw. */
  struct PointEnvelope {
    const CohesiveLaw &law;
    double a, l; ///< factors of strength and opening

    template <int dim>
    PointEnvelope(const OneStepProblem<dim> &problem, const std::size_t point)
        : law(*problem.interactions[problem.interaction[point]].law),
          a(problem.strength_factor[point]), l(problem.opening_factor[point])
    {
    }

    /**
     * The traction at @p reach, unloaded from @p history, over the largest that
     * the point can still carry in that direction. Below 1 the point does not
     * soften; elastic beyond its history.
     */
    double load(const Reach &history, const Reach &reach) const;

    /** Damage begins at the peak of the law, and has not. */
    bool is_elastic_to_the_peak(const Reach &history) const;
  };

  /** How a point went along its law in a step from equilibrium to equilibrium.
   */
  struct Passage {
    /// tractions at both ends over the largest on the way; 1 without damage
    double start = 1., end = 1.;

    /**
     * The least share of the largest traction on the way that one end of the
     * step must have seen.
     */
    static constexpr double least_share = 0.99;

    bool skips_peak() const { return std::max(start, end) < least_share; }
  };

  /** The largest traction between the histories @p history and @p end, Pa. */
  double largest_on_the_way(const PointEnvelope &point, const Reach &history,
                            const Reach &end);

  /** From @p history, open as far as @p start, to the history @p end. */
  Passage passage(const PointEnvelope &point, const Reach &history,
                  const Reach &start, const Reach &end);
} // namespace nsfd
