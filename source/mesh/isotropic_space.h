#pragma once

#include "isotropic.h"

#include <array>

namespace nsfd
{
  /**
   * Tetrahedra of about equal size in a box, with nodes as those of
   * fill_isotropically(): on its edges, then on its sides, then inside.
   * `n_triangles` of the request is the number of tetrahedra. The same in every
   * run, and on every rank.
   */
  void fill_box_isotropically(const std::array<double, 3> &lower,
                              const std::array<double, 3> &upper,
                              IsotropicRequest request, NamedMesh &mesh,
                              std::vector<std::string> &problems);
} // namespace nsfd
