#include "edge_pairs.h"
#include "swept_surfaces.h"

namespace nsfd
{
  namespace
  {
    /** Two edges that pass through each other; the other one is of a later
     * body. */
    class EdgesOnTheWay
    {
    public:
      EdgesOnTheWay(const Surfaces<3> &surfaces, const SweptSurfaces<3> &swept)
          : surfaces_(surfaces), swept_(swept)
      {
      }

      double safe(const Surfaces<3>::Edge &edge) const
      {
        const double length = norm(segment_of(edge, swept_.part(0).from).way);
        return std::min({0.5 * deepest * length, swept_.safe(edge.facet[0]),
                         swept_.safe(edge.facet[1])});
      }

      void look_at(const Surfaces<3>::Edge &a, const Surfaces<3>::Edge &b,
                   std::optional<MissedContact<3>> &first) const
      {
        const double depth = std::min(safe(a), safe(b));
        double way = 0.;
        for (const unsigned int v : a.vertex)
          for (const unsigned int w : b.vertex)
            way = std::max(way, swept_.way(v, w));
        if (way <= depth)
          return;
        for (std::size_t k = 0; k < swept_.n_parts(); ++k) {
          const auto volume = [&](const double s) {
            const Segment p = at(a, k, s), q = at(b, k, s);
            return dot(difference(q.from, p.from), cross(p.way, q.way));
          };
          visit_zeros(volume, [&](const double s, const bool from_above) {
            Place<3> there;
            if (!is_missed(a, b, k, s, from_above, depth, there))
              return;
            MissedContact<3> missed;
            missed.share =
                std::min(1., (double(k) + s) / double(swept_.n_parts()) +
                                 0.5 * depth / way);
            missed.body_1 = surfaces_.facets[b.facet[0]].body;
            missed.body_2 = surfaces_.facets[a.facet[0]].body;
            missed.place = there;
            take_first(first, missed);
          });
        }
      }

    private:
      Segment at(const Surfaces<3>::Edge &edge, const std::size_t k,
                 const double s) const
      {
        const Place<3> from = swept_.part(k).at(edge.vertex[0], s);
        return {from, difference(swept_.part(k).at(edge.vertex[1], s), from)};
      }

      /** Between the normals of its facets; nothing where it does not stick
       * out. */
      std::optional<Place<3>> outward(const Surfaces<3>::Edge &edge,
                                      const std::size_t k, const double s) const
      {
        const Place<3> n_0 = swept_.facet(edge.facet[0], k, s).plane.normal,
                       n_1 = swept_.facet(edge.facet[1], k, s).plane.normal;
        if (!(dot(n_0, n_1) < flat &&
              dot(cross(n_0, n_1), at(edge, k, s).way) > 0.))
          return std::nullopt;
        return sum(n_0, 1., n_1);
      }

      /** They meet at (k, s), and what met has gone on into each other. */
      bool is_missed(const Surfaces<3>::Edge &a, const Surfaces<3>::Edge &b,
                     const std::size_t k, const double s, const bool from_above,
                     const double depth, Place<3> &there) const
      {
        const Segment p = at(a, k, s), q = at(b, k, s);
        const Place<3> c = cross(p.way, q.way),
                       between = difference(q.from, p.from);
        const double square = dot(c, c);
        if (square < least_crossing * least_crossing * dot(p.way, p.way) *
                         dot(q.way, q.way))
          return false;
        const double on_a = dot(cross(between, q.way), c) / square,
                     on_b = dot(cross(between, p.way), c) / square;
        if (std::min({on_a, on_b, 1. - on_a, 1. - on_b}) < edge_end)
          return false;
        const auto out_of_a = outward(a, k, s), out_of_b = outward(b, k, s);
        if (!out_of_a || !out_of_b)
          return false;
        // from b to a: the gap is -volume, over |c|, along c
        const double sign =
            dot(c, difference(*out_of_b, *out_of_a)) > 0. ? 1. : -1.;
        if (from_above == (sign > 0.))
          return false; // they part
        const Place<3> normal = sum({}, sign / std::sqrt(square), c);
        there = sum(q.from, on_b, q.way);
        const std::size_t last = swept_.n_parts() - 1;
        const Segment p_end = at(a, last, 1.), q_end = at(b, last, 1.);
        const double gap =
            dot(normal, difference(sum(p_end.from, on_a, p_end.way),
                                   sum(q_end.from, on_b, q_end.way)));
        return gap < -depth;
      }

      const Surfaces<3> &surfaces_;
      const SweptSurfaces<3> &swept_;
    };
  } // namespace

  template <>
  void find_missed_edges<2>(const Surfaces<2> &, const SweptSurfaces<2> &,
                            const PassingBodies &,
                            std::optional<MissedContact<2>> &)
  {
  }

  template <>
  void find_missed_edges<3>(const Surfaces<3> &surfaces,
                            const SweptSurfaces<3> &swept,
                            const PassingBodies &bodies,
                            std::optional<MissedContact<3>> &first)
  {
    const auto &edges = surfaces.edges;
    std::vector<BoxTree<3>::Entry> entries;
    entries.reserve(edges.size());
    for (unsigned int e = 0; e < edges.size(); ++e)
      entries.emplace_back(
          swept.swept(edges[e].vertex.begin(), edges[e].vertex.end(), 0.), e);
    const BoxTree<3> tree(entries);
    const EdgesOnTheWay on_the_way(surfaces, swept);
    for (unsigned int e = 0; e < edges.size(); ++e) {
      const unsigned int body = surfaces.facets[edges[e].facet[0]].body;
      if (bodies.is_own(body))
        tree.near(entries[e].first, [&](const auto &entry) {
          const auto &other = edges[entry.second];
          const unsigned int its = surfaces.facets[other.facet[0]].body;
          if (its > body && !bodies.joined(body, its))
            on_the_way.look_at(edges[e], other, first);
        });
    }
  }
} // namespace nsfd
