#include "near_candidates.h"

#include "box_tree.h"
#include "edge_pairs.h"
#include "touching_rules.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace nsfd
{
  namespace
  {
    /**
     * Measured in heaps of cells. Above 0.03 sides at right angles stay
     * candidates and a kept step takes 1.4 times as long; from there to 0.4
     * nothing changes, the next cells being a whole size away. A search takes 4
     * to 7 kept steps: 0.2 is cheaper than 0.03 where cells move by more than
     * 0.002 of their size in a step.
     */
    constexpr double skin_per_size = 0.2;

    template <int dim>
    Box<dim> box_of(const typename Surfaces<dim>::Facet &facet, const double *x)
    {
      Place<dim> low = place<dim>(x, facet.vertex[0]), high = low;
      for (unsigned int i = 1; i < facet.n_vertices; ++i)
        for (int d = 0; d < dim; ++d) {
          const double value = x[std::size_t(facet.vertex[i]) * dim + d];
          low[d] = std::min(low[d], value);
          high[d] = std::max(high[d], value);
        }
      return box_around<dim>(low, high, 0.);
    }

    template <int dim>
    BoxTree<dim> tree_of_facets(const Surfaces<dim> &surfaces, const double *x)
    {
      std::vector<typename BoxTree<dim>::Entry> entries;
      entries.reserve(surfaces.facets.size());
      for (unsigned int f = 0; f < surfaces.facets.size(); ++f)
        if (surfaces.facets[f].touches)
          entries.emplace_back(box_of<dim>(surfaces.facets[f], x), f);
      return BoxTree<dim>(entries);
    }

    template <int dim>
    double square_distance(const Box<dim> &box, const Place<dim> &y)
    {
      const auto out = [](const double low, const double high,
                          const double at) {
        const double distance = std::max({0., low - at, at - high});
        return distance * distance;
      };
      namespace bg = boost::geometry;
      const auto &low = box.min_corner(), &high = box.max_corner();
      double result = out(bg::get<0>(low), bg::get<0>(high), y[0]) +
                      out(bg::get<1>(low), bg::get<1>(high), y[1]);
      if constexpr (dim == 3)
        result += out(bg::get<2>(low), bg::get<2>(high), y[2]);
      return result;
    }

    /** What a facet may become before the next search. */
    struct Change {
      double size = 0.; ///< the largest
      double turn = 2.; ///< of the unit normal, the length of its change
      /// distance of the vertices from the plane, now
      double warp = std::numeric_limits<double>::max();
    };

    /**
     * The normal is that of a product of two lengths (of one in the plane):
     * each changes by at most the skin.
     */
    template <int dim>
    Change change_of(const typename Surfaces<dim>::Facet &facet,
                     const Plane<dim> &plane, const double *x,
                     const double skin)
    {
      const auto edge = [&](const unsigned int i, const unsigned int j) {
        return norm(difference(place<dim>(x, facet.vertex[i]),
                               place<dim>(x, facet.vertex[j])));
      };
      double product = plane.size, more = skin;
      if (dim == 3) {
        const bool four = facet.n_vertices == 4;
        product = 2. * plane.size * plane.size;
        more *= edge(four ? 2 : 1, 0) + edge(four ? 3 : 2, four ? 1 : 0) + skin;
      }
      Change result;
      result.size =
          dim == 2 ? product + more : std::sqrt((product + more) / 2.);
      // a sliver may turn over: neither its normal nor its plane say anything
      if (more >= product)
        return result;
      const double sine = more / product;
      result.turn = std::sqrt(2. - 2. * std::sqrt(1. - sine * sine));
      result.warp =
          std::abs(dot(plane.normal, difference(place<dim>(x, facet.vertex[0]),
                                                plane.centre)));
      return result;
    }

    template <int dim>
    class FacetFilter
    {
    public:
      FacetFilter(const Surfaces<dim> &surfaces, const double *x,
                  const std::vector<Plane<dim>> &planes, const double reach,
                  const double skin)
          : surfaces_(surfaces), planes_(planes), x_(x), reach_(reach),
            skin_(skin), changes_(planes.size())
      {
        for (std::size_t f = 0; f < planes.size(); ++f)
          changes_[f] = change_of<dim>(surfaces.facets[f], planes[f], x, skin);
      }

      /** Half the box in which the facets near a point are. */
      double margin(const typename Surfaces<dim>::Point &point) const
      {
        return std::max(reach_, deepest * changes_[point.facet].size) +
               room(point);
      }

      bool may_touch(const typename Surfaces<dim>::Point &point,
                     const typename BoxTree<dim>::Entry &entry) const
      {
        const unsigned int f = entry.second;
        const Plane<dim> &own = planes_[point.facet], &plane = planes_[f];
        const Change &own_change = changes_[point.facet], &change = changes_[f];
        if (dot(own.normal, plane.normal) >=
            opposed_below + own_change.turn + change.turn)
          return false;
        const double more = room(point);
        const double depth =
            deepest * std::min(own_change.size, change.size) + more;
        const Place<dim> y = place<dim>(x_, point.vertex);
        const Place<dim> way = difference(y, plane.centre);
        const double height = dot(plane.normal, way);
        if (height > reach_ + more + change.warp ||
            height < -depth - change.warp)
          return false;
        const double distance = std::max(reach_ + more, depth);
        return square_distance<dim>(entry.first, y) <= distance * distance;
      }

    private:
      /**
       * What the inset allows beyond the end of a facet, and the skin: a tenth
       * more for the inset of what moves, and for round-off.
       */
      double room(const typename Surfaces<dim>::Point &point) const
      {
        const Place<dim> way = difference(place<dim>(x_, point.vertex),
                                          planes_[point.facet].centre);
        return 1.1 * skin_ + inset * norm(way);
      }

      const Surfaces<dim> &surfaces_;
      const std::vector<Plane<dim>> &planes_;
      const double *x_;
      double reach_, skin_;
      std::vector<Change> changes_;
    };

    /** Points by vertex, so that a vertex is looked up once. */
    template <int dim>
    std::vector<unsigned int> points_by_vertex(const Surfaces<dim> &surfaces)
    {
      std::vector<std::size_t> next(surfaces.n_vertices + 1, 0);
      for (const auto &point : surfaces.points)
        ++next[point.vertex + 1];
      std::partial_sum(next.begin(), next.end(), next.begin());
      std::vector<unsigned int> result(surfaces.points.size());
      for (unsigned int i = 0; i < result.size(); ++i)
        result[next[surfaces.points[i].vertex]++] = i;
      return result;
    }

    template <int dim>
    IndexLists
    facets_of_points(const Surfaces<dim> &surfaces, const double *x,
                     const std::vector<unsigned int> &order,
                     const BoxTree<dim> &tree, const FacetFilter<dim> &filter,
                     const OwnBodies &is_own, const AreJoined &joined)
    {
      IndexLists result;
      result.first.reserve(order.size() + 1);
      result.first.push_back(0);
      std::vector<typename BoxTree<dim>::Entry> near;
      for (std::size_t i = 0, end = 0; i < order.size(); i = end) {
        const auto &point = surfaces.points[order[i]];
        const unsigned int body = surfaces.facets[point.facet].body;
        double margin = 0.;
        for (; end < order.size() &&
               surfaces.points[order[end]].vertex == point.vertex;
             ++end)
          margin = std::max(margin, filter.margin(surfaces.points[order[end]]));
        if (!is_own(body)) {
          result.first.resize(end + 1, result.entries.size());
          continue;
        }
        const Place<dim> y = place<dim>(x, point.vertex);
        near.clear();
        tree.near(box_around<dim>(y, y, margin), [&](const auto &entry) {
          const unsigned int other = surfaces.facets[entry.second].body;
          if (other != body && !joined(body, other))
            near.push_back(entry);
        });
        for (std::size_t j = i; j < end; ++j) {
          for (const auto &entry : near)
            if (filter.may_touch(surfaces.points[order[j]], entry) &&
                !(surfaces.is_behind &&
                  surfaces.is_behind(point.vertex, entry.second)))
              result.entries.push_back(entry.second);
          result.first.push_back(result.entries.size());
        }
      }
      return result;
    }

    template <int dim>
    Box<dim> box_of(const typename Surfaces<dim>::Ball &ball, const double *x,
                    const double margin)
    {
      const Place<dim> y = place<dim>(x, ball.vertex);
      return box_around<dim>(y, y, ball.radius + margin);
    }

    template <int dim>
    IndexLists facets_of_balls(const Surfaces<dim> &surfaces, const double *x,
                               const BoxTree<dim> &tree, const double margin,
                               const OwnBodies &is_own, const AreJoined &joined)
    {
      IndexLists result;
      result.first.push_back(0);
      for (const auto &ball : surfaces.balls) {
        if (is_own(ball.body))
          tree.near(box_of<dim>(ball, x, margin), [&](const auto &entry) {
            const unsigned int other = surfaces.facets[entry.second].body;
            if (other != ball.body && !joined(ball.body, other))
              result.entries.push_back(entry.second);
          });
        result.first.push_back(result.entries.size());
      }
      return result;
    }

    template <int dim>
    IndexLists balls_of_balls(const Surfaces<dim> &surfaces, const double *x,
                              const double margin, const OwnBodies &is_own,
                              const AreJoined &joined)
    {
      const auto &balls = surfaces.balls;
      std::vector<typename BoxTree<dim>::Entry> entries;
      for (unsigned int b = 0; b < balls.size(); ++b)
        entries.emplace_back(box_of<dim>(balls[b], x, 0.), b);
      const BoxTree<dim> tree(entries);
      IndexLists result;
      result.first.push_back(0);
      for (unsigned int b = 0; b < balls.size(); ++b) {
        if (is_own(balls[b].body))
          tree.near(box_of<dim>(balls[b], x, margin), [&](const auto &entry) {
            const unsigned int other = balls[entry.second].body;
            if (entry.second > b && other != balls[b].body &&
                !joined(balls[b].body, other))
              result.entries.push_back(entry.second);
          });
        // the pairs of a ball come in the order of the others
        std::sort(result.entries.begin() + result.first.back(),
                  result.entries.end());
        result.first.push_back(result.entries.size());
      }
      return result;
    }

    Box<3> box_of(const Segment &segment, const double margin)
    {
      Place<3> low = segment.from, high = sum(segment.from, 1., segment.way);
      for (int d = 0; d < 3; ++d)
        if (low[d] > high[d])
          std::swap(low[d], high[d]);
      return box_around<3>(low, high, margin);
    }

    /**
     * Where the edges of two bodies are as near to each other as they may be
     * deep in each other, with the skin.
     */
    IndexLists edges_of_edges(const Surfaces<3> &surfaces, const double *x,
                              const std::vector<Plane<3>> &planes,
                              const double reach, const double skin,
                              const OwnBodies &is_own, const AreJoined &joined)
    {
      const auto &edges = surfaces.edges;
      std::vector<Segment> segments(edges.size());
      std::vector<double> margins(edges.size());
      std::vector<BoxTree<3>::Entry> entries;
      entries.reserve(edges.size());
      for (unsigned int e = 0; e < edges.size(); ++e) {
        segments[e] = segment_of(edges[e], x);
        double size = norm(segments[e].way) + skin;
        for (const unsigned int f : edges[e].facet)
          size = std::min(
              size, change_of<3>(surfaces.facets[f], planes[f], x, skin).size);
        // a tenth more than the skin for round-off
        margins[e] = std::max(reach, deepest * size) + 1.1 * skin;
        entries.emplace_back(box_of(segments[e], 0.), e);
      }
      const BoxTree<3> tree(entries);
      IndexLists result;
      result.first.reserve(edges.size() + 1);
      result.first.push_back(0);
      for (unsigned int e = 0; e < edges.size(); ++e) {
        const unsigned int body = surfaces.facets[edges[e].facet[0]].body;
        if (!is_own(body)) {
          result.first.push_back(result.entries.size());
          continue;
        }
        tree.near(box_of(segments[e], margins[e]), [&](const auto &entry) {
          const unsigned int o = entry.second;
          const unsigned int other = surfaces.facets[edges[o].facet[0]].body;
          if (other <= body)
            return;
          const double margin = std::min(margins[e], margins[o]);
          if (square_distance(segments[e], segments[o]) <= margin * margin &&
              !joined(body, other))
            result.entries.push_back(o);
        });
        std::sort(result.entries.begin() + long(result.first.back()),
                  result.entries.end());
        result.first.push_back(result.entries.size());
      }
      return result;
    }
  } // namespace

  template <int dim>
  double skin_of(const Surfaces<dim> &surfaces,
                 const std::vector<Plane<dim>> &planes)
  {
    double facets = 0., balls = 0.;
    for (const auto &plane : planes)
      facets += plane.size / planes.size();
    for (const auto &ball : surfaces.balls)
      balls += 2. * ball.radius / surfaces.balls.size();
    const double size = planes.empty()           ? balls
                        : surfaces.balls.empty() ? facets
                                                 : std::min(facets, balls);
    return skin_per_size * size;
  }

  std::vector<std::array<unsigned int, 2>>
  next_facets(const Surfaces<2> &surfaces)
  {
    constexpr unsigned int none = NearCandidates::no_facet;
    std::vector<std::array<unsigned int, 2>> at(surfaces.n_vertices,
                                                {none, none});
    std::vector<char> count(surfaces.n_vertices, 0);
    for (unsigned int f = 0; f < surfaces.facets.size(); ++f)
      for (unsigned int v = 0; v < 2; ++v) {
        const unsigned int vertex = surfaces.facets[f].vertex[v];
        count[vertex] = char(std::min(count[vertex] + 1, 3));
        if (count[vertex] <= 2)
          at[vertex][count[vertex] - 1] = f;
      }
    std::vector<std::array<unsigned int, 2>> result(surfaces.facets.size(),
                                                    {none, none});
    for (unsigned int f = 0; f < result.size(); ++f)
      for (unsigned int v = 0; v < 2; ++v) {
        const unsigned int vertex = surfaces.facets[f].vertex[v];
        if (count[vertex] == 2)
          result[f][v] = at[vertex][at[vertex][0] == f ? 1 : 0];
      }
    return result;
  }

  template <int dim>
  NearCandidates
  search_candidates(const Surfaces<dim> &surfaces, const double *x,
                    const std::vector<Plane<dim>> &planes, const double reach,
                    const double skin, const OwnBodies &is_own,
                    const AreJoined &joined)
  {
    NearCandidates result;
    const BoxTree<dim> tree = tree_of_facets<dim>(surfaces, x);
    result.order = points_by_vertex<dim>(surfaces);
    result.facets_of_points = facets_of_points<dim>(
        surfaces, x, result.order, tree,
        FacetFilter<dim>(surfaces, x, planes, reach, skin), is_own, joined);
    // a tenth more than the skin for round-off
    const double margin = reach + 1.1 * skin;
    result.facets_of_balls =
        facets_of_balls<dim>(surfaces, x, tree, margin, is_own, joined);
    result.balls_of_balls =
        balls_of_balls<dim>(surfaces, x, margin, is_own, joined);
    if constexpr (dim == 2)
      result.next_facets = next_facets(surfaces);
    else if (!surfaces.edges.empty())
      result.edges_of_edges =
          edges_of_edges(surfaces, x, planes, reach, skin, is_own, joined);
    return result;
  }

#define INSTANTIATE(dim)                                                       \
  template double skin_of<dim>(const Surfaces<dim> &,                          \
                               const std::vector<Plane<dim>> &);               \
  template NearCandidates search_candidates<dim>(                              \
      const Surfaces<dim> &, const double *, const std::vector<Plane<dim>> &,  \
      double, double, const OwnBodies &, const AreJoined &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
