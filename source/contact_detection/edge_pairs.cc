#include "edge_pairs.h"

#include "touching_rules.h"

#include <algorithm>
#include <tuple>

namespace nsfd
{
  namespace
  {
    using Edge = Surfaces<3>::Edge;
    using Planes = std::vector<Plane<3>>;

    /**
     * Into facet 0 and facet 1, across the edge; longer than a unit vector by
     * the length of the edge.
     */
    std::array<Place<3>, 2> inward(const Edge &edge, const Planes &planes,
                                   const Place<3> &way)
    {
      return {cross(planes[edge.facet[0]].normal, way),
              cross(way, planes[edge.facet[1]].normal)};
    }

    /** Lengths within which a touch belongs to this edge: a plate is thin. */
    double size_of(const Edge &edge, const Planes &planes, const double length)
    {
      double size = length;
      for (const unsigned int f : edge.facet)
        size = std::min(
            {size, planes[f].size, planes[f].size * planes[f].size / length});
      return size;
    }

    class Crossings
    {
    public:
      Crossings(const Surfaces<3> &surfaces, const double *x,
                const Planes &planes, const double reach)
          : surfaces_(surfaces), planes_(planes), reach_(reach)
      {
        // in a row: those of other bodies are far away in x
        segments_.reserve(surfaces.edges.size());
        for (const auto &edge : surfaces.edges)
          segments_.push_back(segment_of(edge, x));
      }

      /**
       * The common perpendicular, with a signed length: below zero the edges
       * have passed through each other. Which way is out is said by the facets,
       * not by the sign: two convex bodies are separated by a plane along both
       * edges exactly if its normal is one of the normals around each of them.
       */
      bool find(EdgePair<3> &pair) const
      {
        const Segment &a = segments_[pair.edge], &b = segments_[pair.other];
        const Place<3> c = cross(a.way, b.way),
                       between = difference(b.from, a.from);
        const double square = dot(c, c);
        if (square < least_crossing * least_crossing * dot(a.way, a.way) *
                         dot(b.way, b.way))
          return false;
        pair.place = dot(cross(between, b.way), c) / square;
        pair.other_place = dot(cross(between, a.way), c) / square;
        const double rest = to_end(pair.place),
                     other_rest = to_end(pair.other_place);
        if (std::min(rest, other_rest) < -same_length ||
            std::max(rest, other_rest) <= edge_end)
          return false;
        const double length = norm(c);
        pair.normal = sum({}, 1. / length, c);
        pair.gap = -dot(between, pair.normal);
        const double a_length = norm(a.way), b_length = norm(b.way);
        if (std::abs(pair.gap) > reach_ &&
            std::abs(pair.gap) > deepest * std::min(a_length, b_length))
          return false;
        const Edge &edge = surfaces_.edges[pair.edge],
                   &other = surfaces_.edges[pair.other];
        if (!sticks_out(edge, planes_, a.way) ||
            !sticks_out(other, planes_, b.way))
          return false;
        const double lack =
            lack_of_room(inward(edge, planes_, a.way), a_length,
                         inward(other, planes_, b.way), b_length, pair);
        const double size = std::min(size_of(edge, planes_, a_length),
                                     size_of(other, planes_, b_length));
        const double turn = std::abs(pair.gap) <= reach_
                                ? std::min(reach_ / size, most_turn)
                                : 0.;
        if (lack > std::max(cone_room, turn))
          return false;
        pair.is_sure = lack <= cone_room;
        pair.closest = sum(b.from, pair.other_place, b.way);
        return pair.gap <= reach_ && pair.gap >= -deepest * size;
      }

    private:
      static double to_end(const double place)
      {
        return std::min(place, 1. - place);
      }

      /**
       * Looks which way leads out of both bodies, from the other one to this
       * one, and turns the normal there. By how much it leads into a facet, as
       * a sine, below zero if into none.
       */
      static double lack_of_room(const std::array<Place<3>, 2> &into,
                                 const double length,
                                 const std::array<Place<3>, 2> &into_other,
                                 const double other_length, EdgePair<3> &pair)
      {
        double forth = -1., back = -1.;
        for (unsigned int i = 0; i < 2; ++i) {
          const double own = dot(pair.normal, into[i]) / length,
                       opposite =
                           -dot(pair.normal, into_other[i]) / other_length;
          forth = std::max({forth, -own, -opposite});
          back = std::max({back, own, opposite});
        }
        if (forth <= back)
          return forth;
        pair.normal = sum({}, -1., pair.normal);
        pair.gap = -pair.gap;
        return back;
      }

      const Surfaces<3> &surfaces_;
      std::vector<Segment> segments_; ///< by edge
      const Planes &planes_;
      double reach_;
    };

    /** A side of a facet, its vertices in order. */
    struct Side {
      unsigned int low, high;
      std::uint64_t key; ///< of the facet
      unsigned int facet;
      bool upward; ///< from low to high around the facet
    };

    std::vector<Side> sides_of(const Surfaces<3> &surfaces)
    {
      std::vector<Side> sides;
      for (unsigned int f = 0; f < surfaces.facets.size(); ++f) {
        const auto &facet = surfaces.facets[f];
        for (unsigned int i = 0; i < facet.n_vertices; ++i) {
          const unsigned int a = facet.vertex[i],
                             b = facet.vertex[(i + 1) % facet.n_vertices];
          sides.push_back(
              {std::min(a, b), std::max(a, b), facet.key, f, a < b});
        }
      }
      std::sort(sides.begin(), sides.end(), [](const auto &l, const auto &r) {
        return std::tie(l.low, l.high, l.key) < std::tie(r.low, r.high, r.key);
      });
      return sides;
    }
  } // namespace

  bool sticks_out(const Edge &edge, const Planes &planes, const Place<3> &way)
  {
    const Place<3> &n_0 = planes[edge.facet[0]].normal,
                   &n_1 = planes[edge.facet[1]].normal;
    return dot(n_0, n_1) < flat && dot(cross(n_0, n_1), way) > 0.;
  }

  Segment segment_of(const Edge &edge, const double *x)
  {
    const Place<3> from = place<3>(x, edge.vertex[0]);
    return {from, difference(place<3>(x, edge.vertex[1]), from)};
  }

  double square_distance(const Segment &a, const Segment &b)
  {
    const Place<3> between = difference(b.from, a.from);
    const double aa = dot(a.way, a.way), bb = dot(b.way, b.way),
                 ab = dot(a.way, b.way), ra = dot(between, a.way),
                 rb = dot(between, b.way), square = aa * bb - ab * ab;
    // on the lines, then as near as the ends allow; any s for parallel ones
    double s =
        square > 0. ? std::clamp((ra * bb - rb * ab) / square, 0., 1.) : 0.;
    const double t = (ab * s - rb) / bb;
    if (t < 0.)
      s = std::clamp(ra / aa, 0., 1.);
    else if (t > 1.)
      s = std::clamp((ra + ab) / aa, 0., 1.);
    const Place<3> way = difference(sum(between, std::clamp(t, 0., 1.), b.way),
                                    sum({}, s, a.way));
    return dot(way, way);
  }

  template <>
  void set_edges<2>(Surfaces<2> &, const double *,
                    const std::function<bool(unsigned int)> &)
  {
  }

  template <>
  void set_edges<3>(Surfaces<3> &surfaces, const double *x,
                    const std::function<bool(unsigned int)> &keeps_shape)
  {
    Planes planes;
    set_planes<3>(surfaces, x, planes);
    surfaces.edges.clear();
    const auto sides = sides_of(surfaces);
    for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
      for (; end < sides.size() && sides[end].low == sides[i].low &&
             sides[end].high == sides[i].high;
           ++end)
        ;
      if (end != i + 2 || sides[i].upward == sides[i + 1].upward)
        continue;
      Edge edge{{sides[i].low, sides[i].high},
                {sides[i].facet, sides[i + 1].facet}};
      if (!sides[i].upward)
        std::swap(edge.vertex[0], edge.vertex[1]);
      if (!keeps_shape(surfaces.facets[edge.facet[0]].body) ||
          sticks_out(edge, planes, segment_of(edge, x).way))
        surfaces.edges.push_back(edge);
    }
  }

  template <>
  void find_crossings<2>(const Surfaces<2> &, const double *,
                         const std::vector<Plane<2>> &, double,
                         const NearCandidates &,
                         std::vector<EdgePair<2>> &pairs)
  {
    pairs.clear();
  }

  template <>
  void find_crossings<3>(const Surfaces<3> &surfaces, const double *x,
                         const Planes &planes, const double reach,
                         const NearCandidates &candidates,
                         std::vector<EdgePair<3>> &pairs)
  {
    pairs.clear();
    const Crossings crossings(surfaces, x, planes, reach);
    const auto &lists = candidates.edges_of_edges;
    if (surfaces.edges.empty())
      return;
    EdgePair<3> pair;
    for (pair.edge = 0; pair.edge < surfaces.edges.size(); ++pair.edge)
      for (std::size_t i = lists.first[pair.edge];
           i < lists.first[pair.edge + 1]; ++i) {
        pair.other = lists.entries[i];
        if (crossings.find(pair))
          pairs.push_back(pair);
      }
  }
} // namespace nsfd
