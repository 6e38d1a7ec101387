#pragma once

#include "facet_geometry.h"

namespace nsfd
{
  /** The facets that points touch; see SurfaceSearch. */
  template <int dim>
  void find_point_pairs(const Surfaces<dim> &surfaces, const double *x,
                        const std::vector<Plane<dim>> &planes, double reach,
                        const NearCandidates &candidates,
                        std::vector<FacetPair<dim>> &pairs);
} // namespace nsfd
