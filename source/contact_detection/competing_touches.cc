#include "edge_pairs.h"

#include "touching_rules.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /**
     * Takes away what does not touch: a corner under a facet that is outside of
     * the body, in front of the next facet of a sharp edge.
     *
     * Touches of the same two bodies compete. Two that are near to each other
     * with the same normal say the same: corners stay, then keys decide. A
     * corner over a facet next to the crossing, whose edge leads below that
     * facet, is not where they meet: so are the nodes inside a long edge. Two
     * that belong to neighbouring corners and edges, both inside, with
     * different normals: the bodies have come through the one that is less deep
     * (as the shortest way out parts two convex bodies), the other one would be
     * a wall inside of them.
     */
    class Competition
    {
    public:
      using Edge = Surfaces<3>::Edge;
      using Planes = std::vector<Plane<3>>;

      Competition(const Surfaces<3> &surfaces, const double *x,
                  const Planes &planes, std::vector<FacetPair<3>> &points,
                  std::vector<EdgePair<3>> &pairs)
          : surfaces_(surfaces), x_(x), planes_(planes), points_(points),
            pairs_(pairs), point_lost_(points.size(), 0),
            pair_lost_(pairs.size(), 0)
      {
      }

      void run()
      {
        for (std::size_t i = 0; i < points_.size(); ++i)
          point_lost_[i] = is_outside(points_[i]);
        remove(points_, point_lost_);
        point_lost_.assign(points_.size(), 0);
        for (std::size_t k = 0; k < pairs_.size(); ++k)
          compare_with_points(k);
        remove(pairs_, pair_lost_);
        remove(points_, point_lost_);
        pair_lost_.assign(pairs_.size(), 0);
        compare_pairs();
        remove(pairs_, pair_lost_);
      }

    private:
      template <typename Touch>
      static void remove(std::vector<Touch> &touches,
                         const std::vector<char> &lost)
      {
        std::size_t n = 0;
        for (std::size_t k = 0; k < touches.size(); ++k)
          if (!lost[k])
            touches[n++] = touches[k];
        touches.resize(n);
      }

      const Edge &edge(const EdgePair<3> &pair) const
      {
        return surfaces_.edges[pair.edge];
      }
      const Edge &other(const EdgePair<3> &pair) const
      {
        return surfaces_.edges[pair.other];
      }
      double length(const Edge &edge) const
      {
        return norm(segment_of(edge, x_).way);
      }
      double facet_size(const Edge &edge) const
      {
        return std::min(planes_[edge.facet[0]].size,
                        planes_[edge.facet[1]].size);
      }
      double size(const EdgePair<3> &pair) const
      {
        return std::min(facet_size(edge(pair)), facet_size(other(pair)));
      }

      bool is_outside(const FacetPair<3> &touch) const
      {
        const auto &point = surfaces_.points[touch.index];
        const auto &facet = surfaces_.facets[touch.facet];
        const Plane<3> &own = planes_[point.facet];
        const double rounding = same_length * own.size;
        if (touch.gap > -rounding)
          return false;
        // flush boxes overhang by a hair, which is not for the depths of others
        const Place<3> y = place<3>(x_, point.vertex),
                       inside = -touch.gap > touch.inset
                                    ? y
                                    : sum(y, inset, difference(own.centre, y));
        for (unsigned int i = 0; i < facet.n_vertices; ++i) {
          const Edge *edge = find_edge(
              facet.vertex[i], facet.vertex[(i + 1) % facet.n_vertices]);
          if (!edge || !sticks_out(*edge, planes_, segment_of(*edge, x_).way))
            continue;
          const Plane<3> &next =
              planes_[edge->facet[0] == touch.facet ? edge->facet[1]
                                                    : edge->facet[0]];
          if (dot(next.normal, difference(inside, next.centre)) > rounding)
            return true;
        }
        return false;
      }

      /** They are in order, see set_edges(). */
      const Edge *find_edge(const unsigned int a, const unsigned int b) const
      {
        const auto ends = [](const Edge &edge) {
          return std::minmax(edge.vertex[0], edge.vertex[1]);
        };
        const auto wanted = std::minmax(a, b);
        const auto edge = std::lower_bound(
            surfaces_.edges.begin(), surfaces_.edges.end(), wanted,
            [&](const Edge &e, const auto &value) { return ends(e) < value; });
        return edge != surfaces_.edges.end() && ends(*edge) == wanted ? &*edge
                                                                      : nullptr;
      }

      // ----------------------------------------------- an edge and corners

      void compare_with_points(const std::size_t k)
      {
        const auto &pair = pairs_[k];
        for (const unsigned int end : {0u, 1u}) {
          compare_with_vertex(k, edge(pair), end, pair.place, other(pair), 1.);
          compare_with_vertex(k, other(pair), end, pair.other_place, edge(pair),
                              -1.);
        }
      }

      /** @p sign: +1 if a point here looks along the normal of the pair. */
      void compare_with_vertex(const std::size_t k, const Edge &own,
                               const unsigned int end, const double place,
                               const Edge &opposite, const double sign)
      {
        const auto vertex_of = [this](const FacetPair<3> &point) {
          return surfaces_.points[point.index].vertex;
        };
        const unsigned int vertex = own.vertex[end];
        auto point = std::lower_bound(points_.begin(), points_.end(), vertex,
                                      [&](const auto &p, const unsigned int v) {
                                        return vertex_of(p) < v;
                                      });
        for (; point != points_.end() && vertex_of(*point) == vertex; ++point) {
          if (surfaces_.facets[point->facet].body !=
              surfaces_.facets[opposite.facet[0]].body)
            continue;
          const auto &pair = pairs_[k];
          if (sign * dot(point->normal, pair.normal) > same_direction) {
            const double distance =
                (end == 0 ? place : 1. - place) * length(own);
            pair_lost_[k] |= distance < same_place * size(pair);
          } else if (is_beside(opposite, point->facet)) {
            const double rounding = same_length * size(pair);
            if (!pair.is_sure) {
              // may come to lie so, but the corner has come in elsewhere
              pair_lost_[k] |=
                  point->gap < -rounding && pair.gap < point->gap - rounding;
              continue;
            }
            const Segment segment = segment_of(own, x_);
            const double climb = (end == 0 ? 1. : -1.) *
                                 dot(point->normal, segment.way) /
                                 norm(segment.way);
            if (climb < -cone_room) {
              point_lost_[std::size_t(point - points_.begin())] = 1;
              continue;
            }
            if (pair.gap > -rounding)
              continue;
            if (point->gap > -rounding) {
              // all of the edge is in front of the facet that ends where it
              // is said to have come in
              if (climb > cone_room)
                pair_lost_[k] = 1;
              continue;
            }
            if (pair.gap > point->gap + rounding)
              point_lost_[std::size_t(point - points_.begin())] = 1;
            else
              pair_lost_[k] = 1;
          }
        }
      }

      /** The side of the facet ends at the edge. */
      bool is_beside(const Edge &edge, const unsigned int facet) const
      {
        const auto side = [this](const unsigned int f) {
          return surfaces_.facets[f].side;
        };
        return side(facet) == side(edge.facet[0]) ||
               side(facet) == side(edge.facet[1]);
      }

      // ------------------------------------------------- pairs of edges

      void compare_pairs()
      {
        std::vector<std::pair<unsigned int, std::size_t>> at_vertex;
        for (std::size_t k = 0; k < pairs_.size(); ++k)
          for (const unsigned int v : edge(pairs_[k]).vertex)
            at_vertex.emplace_back(v, k);
        std::sort(at_vertex.begin(), at_vertex.end());
        for (std::size_t i = 0; i < at_vertex.size(); ++i)
          for (std::size_t j = i + 1;
               j < at_vertex.size() && at_vertex[j].first == at_vertex[i].first;
               ++j)
            if (are_neighbours(other(pairs_[at_vertex[i].second]),
                               other(pairs_[at_vertex[j].second])))
              compare(at_vertex[i].second, at_vertex[j].second);
      }

      static bool are_neighbours(const Edge &a, const Edge &b)
      {
        return std::any_of(a.vertex.begin(), a.vertex.end(), [&](auto v) {
          return v == b.vertex[0] || v == b.vertex[1];
        });
      }

      void compare(const std::size_t k, const std::size_t l)
      {
        const auto &a = pairs_[k], &b = pairs_[l];
        const double length = std::min(size(a), size(b)),
                     rounding = same_length * length;
        if (dot(a.normal, b.normal) > same_direction) {
          if (norm(difference(a.closest, b.closest)) < same_place * length)
            pair_lost_[keys(a) < keys(b) ? l : k] = 1;
        } else if (a.is_sure && b.is_sure &&
                   std::max(a.gap, b.gap) <= -rounding)
          pair_lost_[a.gap > b.gap + rounding   ? l
                     : b.gap > a.gap + rounding ? k
                     : keys(a) < keys(b)        ? l
                                                : k] = 1;
      }

      std::array<std::uint64_t, 4> keys(const EdgePair<3> &pair) const
      {
        const auto key = [this](const unsigned int f) {
          return surfaces_.facets[f].key;
        };
        return {key(edge(pair).facet[0]), key(edge(pair).facet[1]),
                key(other(pair).facet[0]), key(other(pair).facet[1])};
      }

      const Surfaces<3> &surfaces_;
      const double *x_;
      const Planes &planes_;
      std::vector<FacetPair<3>> &points_;
      std::vector<EdgePair<3>> &pairs_;
      std::vector<char> point_lost_, pair_lost_;
    };
  } // namespace

  template <>
  void settle_touches<2>(const Surfaces<2> &, const double *,
                         const std::vector<Plane<2>> &,
                         std::vector<FacetPair<2>> &,
                         std::vector<EdgePair<2>> &)
  {
  }

  template <>
  void settle_touches<3>(const Surfaces<3> &surfaces, const double *x,
                         const std::vector<Plane<3>> &planes,
                         std::vector<FacetPair<3>> &points,
                         std::vector<EdgePair<3>> &pairs)
  {
    if (!surfaces.edges.empty())
      Competition(surfaces, x, planes, points, pairs).run();
  }
} // namespace nsfd
