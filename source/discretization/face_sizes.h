#pragma once

#include "bodies.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace nsfd
{
  /** By point the size of its face, m: its length, in space the root of its
      area. */
  template <int dim>
  std::vector<double> face_sizes(const InterfacePoints<dim> &points)
  {
    std::vector<double> sizes(points.n_points);
    for (const auto &face : points.faces) {
      double area = 0.;
      for (unsigned int i = face.first; i < face.first + face.count; ++i)
        area += points.weight[i];
      std::fill_n(sizes.begin() + face.first, face.count,
                  dim == 2 ? area : std::sqrt(area));
    }
    return sizes;
  }
} // namespace nsfd
