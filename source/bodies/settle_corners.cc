#include "settle_corners.h"

#include "contact_detection/touching_rules.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  template <int dim>
  void settle_corners(const ActiveSurfaces<dim> &active, const double same,
                      std::vector<FacetPair<dim>> &points)
  {
    if (!active.wholes().node.empty()) // a corner is one node
      return;
    constexpr double together = 0.01;
    const auto &surfaces = active.set().surfaces;
    const auto &motion = active.motion();
    struct Inside {
      std::size_t pair;
      double gap;
      const double *rest, *now;
      unsigned int cell, other;
      bool is_kept;
    };
    std::vector<Inside> inside;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto &pair = points[k];
      const auto &point = surfaces.points[pair.index];
      if (pair.gap < 0.)
        inside.push_back(
            {k, pair.gap, motion.rest(point.vertex),
             &motion.positions()[std::size_t(point.vertex) * dim],
             active.set().facet_cells[point.facet],
             active.set().facet_cells[pair.facet],
             point.was_below &&
                 point.last_side == surfaces.facets[pair.facet].side});
    }
    const auto normal_product = [&](const Inside &a, const Inside &b) {
      double sum = 0.;
      for (unsigned int d = 0; d < dim; ++d)
        sum += points[a.pair].normal[d] * points[b.pair].normal[d];
      return sum;
    };
    const auto yields = [&](const Inside &a, const Inside &b) {
      const double apart = same - together * std::max(a.gap, b.gap);
      for (unsigned int d = 0; d < dim; ++d)
        if (!(std::abs(a.rest[d] - b.rest[d]) <= same &&
              std::abs(a.now[d] - b.now[d]) <= apart))
          return false;
      return active.are_one_piece(a.cell, b.cell) &&
             active.are_one_piece(a.other, b.other) &&
             normal_product(a, b) < -face_to_face &&
             (a.is_kept != b.is_kept ? b.is_kept : a.gap < b.gap);
    };
    std::sort(inside.begin(), inside.end(), [](const auto &a, const auto &b) {
      return a.rest[0] != b.rest[0] ? a.rest[0] < b.rest[0] : a.pair < b.pair;
    });
    std::vector<char> lost(points.size(), 0);
    for (std::size_t i = 0; i < inside.size(); ++i)
      for (std::size_t j = i + 1;
           j < inside.size() && inside[j].rest[0] <= inside[i].rest[0] + same;
           ++j) {
        lost[inside[i].pair] |= char(yields(inside[i], inside[j]));
        lost[inside[j].pair] |= char(yields(inside[j], inside[i]));
      }
    std::size_t n = 0;
    for (std::size_t k = 0; k < points.size(); ++k)
      if (!lost[k])
        points[n++] = points[k];
    points.resize(n);
  }

#define INSTANTIATE(dim)                                                       \
  template void settle_corners(const ActiveSurfaces<dim> &, double,            \
                               std::vector<FacetPair<dim>> &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
