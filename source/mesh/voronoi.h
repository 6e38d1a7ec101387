#pragma once

#include "named_mesh.h"

#include <array>
#include <string>
#include <vector>

namespace nsfd
{
  struct PlaneRegions;

  struct VoronoiRequest {
    std::array<double, 2> lower{}, upper{};
    unsigned int grains = 1, seed = 1;
    unsigned int relaxation = 0; ///< steps of Lloyd: seeds to the centroids
    double element_size = 0.;
    double seconds = 20.; ///< of CPU for the mesh
  };

  /**
   * A polycrystal in a rectangle, not yet in order: quads of about the element
   * size in the grains of a Voronoi diagram of random seeds. The cells of a
   * grain are the group `grain 1`, `grain 2`, ..., numbered as the seeds were
   * drawn; the faces between grains are the group `grain boundaries`. Sides of
   * grains much shorter than the cells are collapsed.
   */
  NamedMesh voronoi_mesh(const VoronoiRequest &request,
                         std::vector<std::string> &problems);

  /** The grains alone, in the units of the request. */
  PlaneRegions voronoi_grains(const VoronoiRequest &request,
                              std::vector<std::string> &problems);
} // namespace nsfd
