#pragma once

#include "crack_shape.h"
#include "discretization/bodies.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace nsfd
{
  /**
   * The points of a face. In the plane a face is straight, and the pieces
   * that its points stand for follow each other along it.
   */
  template <int dim>
  std::vector<BrokenPoint>
  pieces_of(const InterfacePoints<dim> &points,
            const typename InterfacePoints<dim>::Face &face)
  {
    const double *Q = points.axes(face.first);
    std::vector<BrokenPoint> pieces(face.count);
    std::vector<double> place(face.count, 0.); // along the first tangent
    double length = 0., middle = 0.;
    for (unsigned int k = 0; k < face.count; ++k) {
      const std::size_t i = face.first + k;
      pieces[k].area = points.weight[i];
      for (unsigned int c = 0; c < dim; ++c) {
        pieces[k].position[c] = points.position[i * dim + c];
        pieces[k].normal[c] = Q[c];
        place[k] += Q[dim + c] * points.position[i * dim + c];
      }
      pieces[k].ends = {pieces[k].position, pieces[k].position};
      length += points.measure(i);
      middle += points.measure(i) * place[k];
    }
    if (dim == 3)
      return pieces;
    std::vector<unsigned int> order(face.count);
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](const unsigned int a, const unsigned int b) {
                return place[a] < place[b];
              });
    double begin = middle / length - length / 2.;
    for (const unsigned int k : order) {
      const double end = begin + points.measure(face.first + k);
      for (unsigned int c = 0; c < dim; ++c) {
        pieces[k].ends[0][c] += (begin - place[k]) * Q[dim + c];
        pieces[k].ends[1][c] += (end - place[k]) * Q[dim + c];
      }
      begin = end;
    }
    return pieces;
  }
} // namespace nsfd
