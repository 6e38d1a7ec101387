#pragma once

#include "facet_geometry.h"

namespace nsfd
{
  /**
   * The places where facets are near balls: those from where every way on the
   * surface leads further from the ball. The edges between the facets of a flat
   * floor are none of them.
   */
  template <int dim>
  void find_ball_pairs(const Surfaces<dim> &surfaces, const double *x,
                       const std::vector<Plane<dim>> &planes, double reach,
                       const NearCandidates &candidates,
                       std::vector<FacetPair<dim>> &pairs);

  template <int dim>
  void find_ball_ball_pairs(const Surfaces<dim> &surfaces, const double *x,
                            double reach, const NearCandidates &candidates,
                            std::vector<BallPair<dim>> &pairs);
} // namespace nsfd
