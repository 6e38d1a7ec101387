#pragma once

#include "bodies.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace nsfd
{
  /** Of a face of this length or, in space, area: its length or the root of
      its area, m. */
  template <int dim>
  double face_size(const double measure)
  {
    return dim == 2 ? measure : std::sqrt(measure);
  }

  /** By point that of its face. */
  template <int dim>
  std::vector<double> face_sizes(const InterfacePoints<dim> &points)
  {
    std::vector<double> sizes(points.n_points);
    for (const auto &face : points.faces) {
      double area = 0.;
      for (unsigned int i = face.first; i < face.first + face.count; ++i)
        area += points.weight[i];
      std::fill_n(sizes.begin() + face.first, face.count, face_size<dim>(area));
    }
    return sizes;
  }
} // namespace nsfd
