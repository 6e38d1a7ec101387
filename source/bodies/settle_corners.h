#pragma once

#include "active_surfaces.h"

#include <vector>

namespace nsfd
{
  /**
   * Where cells are held together by rows, each has a node of its own at a
   * corner of their piece. What is inside of another one has come in one way:
   * of nodes of a corner that say otherwise, the deepest ones are wrong, but
   * what touched there in the last step stays. Nodes are of one corner that are
   * at one place at rest, within @p same (m), and apart now by a hundredth of
   * their overlap at most: the sides of a crack are not.
   *
   * @p points: the contacts of nodes with facets of all ranks, in any order,
   * which stays; those that are wrong are taken out. Nothing is done where
   * nodes of a corner are one, see ActiveSurfaces::wholes().
   */
  template <int dim>
  void settle_corners(const ActiveSurfaces<dim> &active, double same,
                      std::vector<FacetPair<dim>> &points);
} // namespace nsfd
