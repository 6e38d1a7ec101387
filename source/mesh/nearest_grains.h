#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace nsfd
{
  struct NamedMesh;
  template <int dim>
  struct CoarseMesh;

  /**
   * Grains of a mesh that was made without them: a cell belongs to the nearest
   * of @p n random places in the bounding box. Their boundaries follow faces of
   * cells. Of ten candidates each place is the farthest from those before
   * (Mitchell, Computer Graphics 25, 1991), so that grains are of like size.
   */

  /** Groups `grain 1` and so on, numbered behind the other groups of cells. */
  void add_grains(NamedMesh &mesh, unsigned int n, unsigned int seed);

  /** Material ids from 1 on. */
  template <int dim>
  void add_grains(CoarseMesh<dim> &mesh, unsigned int n, unsigned int seed);
} // namespace nsfd
