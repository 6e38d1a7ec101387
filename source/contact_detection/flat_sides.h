#pragma once

#include "surface_search.h"

namespace nsfd
{
  /**
   * Facets that meet and are parallel, of bodies that keep their shape, are one
   * flat side: which of them a corner is over says nothing. @p x: positions of
   * the vertices.
   */
  template <int dim>
  void set_flat_sides(Surfaces<dim> &surfaces, const double *x,
                      const std::function<bool(unsigned int)> &keeps_shape);

  /** Whether @p y is below a facet, between its ends and not deeper than it is
      long. @p x: positions of its vertices. */
  template <int dim>
  bool is_below(const typename Surfaces<dim>::Facet &facet, const double *x,
                const std::array<double, dim> &y);
} // namespace nsfd
