#pragma once

#include "facet_geometry.h"

namespace nsfd
{
  /** from + s way, s from 0 to 1 */
  struct Segment {
    Place<3> from{}, way{};
  };

  Segment segment_of(const Surfaces<3>::Edge &edge, const double *x);

  /** A roof, neither a valley nor flat; @p way leads along the edge. */
  bool sticks_out(const Surfaces<3>::Edge &edge,
                  const std::vector<Plane<3>> &planes, const Place<3> &way);

  /** Between their closest places, ends included. */
  double square_distance(const Segment &a, const Segment &b);

  /**
   * The places where edges cross, between their ends and with a normal that
   * leads out of both bodies there.
   */
  template <int dim>
  void find_crossings(const Surfaces<dim> &surfaces, const double *x,
                      const std::vector<Plane<dim>> &planes, double reach,
                      const NearCandidates &candidates,
                      std::vector<EdgePair<dim>> &pairs);

  /**
   * Of touches that compete with each other, of edges and of @p points (by
   * vertex), one is left: see competing_touches.cc.
   */
  template <int dim>
  void settle_touches(const Surfaces<dim> &surfaces, const double *x,
                      const std::vector<Plane<dim>> &planes,
                      std::vector<FacetPair<dim>> &points,
                      std::vector<EdgePair<dim>> &pairs);
} // namespace nsfd
