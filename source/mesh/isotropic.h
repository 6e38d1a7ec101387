#pragma once

#include "plane_outline.h"
#include "size_field.h"

#include "named_mesh.h"

#include <cstdint>
#include <string>
#include <vector>

namespace nsfd
{
  /** How a mesh without directions is made. */
  struct IsotropicRequest {
    SizeField size;
    double n_triangles = 0.; ///< instead of a size; 0: the size counts
    unsigned int seed = 1;
    unsigned int iterations = 0; ///< of Lloyd
  };

  /**
   * Triangles of about equal size in the parts of an outline, with nodes that
   * are drawn at random and then go to the centroids of their Voronoi cells:
   * no direction is preferred. @p mesh brings the groups and sets that the
   * outline names, and receives the triangles. The same in every run, and on
   * every rank.
   */
  void fill_isotropically(const PlaneOutline &outline,
                          const IsotropicRequest &request, NamedMesh &mesh,
                          std::vector<std::string> &problems);

  /**
   * The nodes of lines that close round a figure, and after them those that
   * such a mesh has inside.
   *
   * @throws std::runtime_error if there are too many, or if lines cross
   */
  std::vector<PlanePoint> place_inner_nodes(const OutlineNodes &lines,
                                            const IsotropicRequest &request);
} // namespace nsfd
