#include "face_points.h"

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

// Which place on the surface of a cell a point of a face has.

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** Of the points of a face, or of a part of it where smaller cells are
        behind: that which a slot is one of. */
    template <int dim>
    Tensor<1, dim> middle_of_part(const BodyShape<dim> &shape,
                                  const std::size_t slot)
    {
      const auto &faces = shape.slot_faces;
      const auto face =
          std::equal_range(faces.begin(), faces.end(), faces[slot]);
      const auto first = std::size_t(face.first - faces.begin());
      auto n = std::size_t(face.second - face.first);
      if (shape.divided >> faces[slot] & 1u)
        n /= 1u << (dim - 1);
      const std::size_t begin = first + (slot - first) / n * n;
      Tensor<1, dim> middle;
      for (std::size_t s = begin; s < begin + n; ++s)
        middle += shape.slot_positions[s] / double(n);
      return middle;
    }
  } // namespace

  template <int dim>
  void fill_slots(const InterfacePoints<dim> &points, Cells<dim> &cells)
  {
    Bodies &bodies = cells.bodies;
    const auto n = unsigned(points.n_points);
    bodies.slot_point.assign(bodies.first_slot.back(), n);
    bodies.slot_sign.assign(bodies.first_slot.back(), 1);
    // the nearest one; where faces of the cell meet, that of the face of the
    // point
    const auto slot_of = [&](const std::size_t b, const BodyShape<dim> &shape,
                             const unsigned int i) {
      const double tolerance = 1e-7 * shape.corners.back().norm();
      const auto &centre = points.faces[points.face_of[i]].centre;
      // how far the face of the point is out of that of a slot
      const auto offset = [&](const std::size_t s) {
        double height = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          height +=
              shape.slot_normals[s][c] *
              (centre[c] - cells.corners[b][0][c] - shape.slot_positions[s][c]);
        return std::abs(height) / shape.slot_normals[s].norm();
      };
      // where small faces meet, that of the right one
      const auto apart = [&](const std::size_t s) {
        Tensor<1, dim> way = cells.corners[b][0] - Point<dim>();
        for (unsigned int c = 0; c < dim; ++c)
          way[c] -= centre[c];
        return (way + middle_of_part(shape, s)).norm();
      };
      const auto is_better = [&](const std::size_t s, const std::size_t best) {
        const double one = offset(s), two = offset(best);
        return one < two - tolerance ||
               (shape.divided != 0 && one < two + tolerance &&
                apart(s) < apart(best) - tolerance);
      };
      std::size_t best = 0;
      double distance = std::numeric_limits<double>::max();
      for (std::size_t s = 0; s < shape.slot_positions.size(); ++s) {
        double d = 0.;
        for (unsigned int c = 0; c < dim; ++c) {
          const double x = cells.corners[b][0][c] + shape.slot_positions[s][c] -
                           points.position[i * dim + c];
          d += x * x;
        }
        if (d < distance - tolerance * tolerance ||
            (d < distance + tolerance * tolerance && is_better(s, best))) {
          distance = d;
          best = s;
        }
      }
      AssertThrow(std::sqrt(distance) < 100. * tolerance,
                  ExcMessage("a face point has no place on its cell"));
      return bodies.first_slot[b] + best;
    };

    // body by body: each has its shape made once
    std::vector<std::size_t> first(cells.corners.size() + 1, 0);
    for (const auto &face : points.faces)
      for (const int b : face.bodies)
        if (b >= 0)
          ++first[std::size_t(b) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::pair<unsigned int, unsigned int>> sides(first.back());
    auto next = first;
    for (unsigned int f = 0; f < points.faces.size(); ++f)
      for (unsigned int side = 0; side < 2; ++side)
        if (const int b = points.faces[f].bodies[side]; b >= 0)
          sides[next[std::size_t(b)]++] = {f, side};
    for (std::size_t b = 0; b + 1 < first.size(); ++b) {
      if (first[b] == first[b + 1])
        continue;
      const auto shape = cells.shape(b);
      for (std::size_t k = first[b]; k < first[b + 1]; ++k) {
        const auto &[f, side] = sides[k];
        const auto &face = points.faces[f];
        for (unsigned int i = face.first; i < face.first + face.count; ++i) {
          const std::size_t slot = slot_of(b, *shape, i);
          if (bodies.slot_point[slot] < n) {
            bodies.extra_points.emplace_back(slot, i);
            AssertThrow(side == 1 && face.boundary,
                        ExcMessage("two interface points on one slot"));
          } else {
            bodies.slot_point[slot] = i;
            bodies.slot_sign[slot] = side == 1 ? 1 : -1;
          }
        }
      }
    }
    std::sort(bodies.extra_points.begin(), bodies.extra_points.end());
  }

  template void fill_slots(const InterfacePoints<2> &, Cells<2> &);
  template void fill_slots(const InterfacePoints<3> &, Cells<3> &);
} // namespace nsfd
