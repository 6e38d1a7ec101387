#pragma once

#include "facet_geometry.h"

namespace nsfd
{
  /** The room left around all boxes, as a length. */
  template <int dim>
  double skin_of(const Surfaces<dim> &surfaces,
                 const std::vector<Plane<dim>> &planes);

  /**
   * Those that each facet meets at its two vertices. Where more than two facets
   * of a body meet, none is the next one.
   */
  std::vector<std::array<unsigned int, 2>>
  next_facets(const Surfaces<2> &surfaces);

  /** Bodies to search for. */
  using OwnBodies = std::function<bool(unsigned int)>;

  /**
   * All that may be a pair at gaps up to `reach` when no vertex has moved by
   * more than skin / 2: what points, balls and edges of the bodies that
   * @p is_own says may be near.
   */
  template <int dim>
  NearCandidates
  search_candidates(const Surfaces<dim> &surfaces, const double *x,
                    const std::vector<Plane<dim>> &planes, double reach,
                    double skin, const OwnBodies &is_own,
                    const AreJoined &joined);
} // namespace nsfd
