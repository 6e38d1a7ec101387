#include "path_ratio.h"

#include "core/mix_bits.h"

#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/graph/dijkstra_shortest_paths_no_color_map.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace nsfd
{
  namespace
  {
    using NetworkPoint = std::array<double, 2>;

    double distance_of(const NetworkPoint &a, const NetworkPoint &b)
    {
      return std::hypot(b[0] - a[0], b[1] - a[1]);
    }

    struct Face {
      double length;
    };
    using Graph = boost::compressed_sparse_row_graph<boost::directedS,
                                                     boost::no_property, Face>;

    /** Both ways of every face. */
    Graph graph_of(const CrackNetwork &network)
    {
      std::vector<std::pair<std::size_t, std::size_t>> ways;
      std::vector<Face> faces;
      for (const auto &[a, b] : network.faces)
        for (const auto &way : {std::pair(a, b), std::pair(b, a)}) {
          ways.emplace_back(way.first, way.second);
          faces.push_back({distance_of(network.points[a], network.points[b])});
        }
      return Graph(boost::edges_are_unsorted_multi_pass, ways.begin(),
                   ways.end(), faces.begin(), network.points.size());
    }

    struct Arrived {
    };

    /** Stops at its goal. */
    class Goal : public boost::default_dijkstra_visitor
    {
    public:
      explicit Goal(const std::size_t goal) : goal_(goal) {}
      void examine_vertex(const std::size_t v, const Graph &) const
      {
        if (v == goal_)
          throw Arrived();
      }

    private:
      std::size_t goal_;
    };

    /** Infinite if there is none. */
    double shortest_way(const Graph &graph, const std::size_t from,
                        const std::size_t to, std::vector<double> &distances)
    {
      try {
        boost::dijkstra_shortest_paths_no_color_map(
            graph, from,
            boost::weight_map(boost::get(&Face::length, graph))
                .distance_map(distances.data())
                .visitor(Goal(to)));
      } catch (const Arrived &) {
      }
      return distances[to];
    }

    /** Faces at each point. */
    std::vector<unsigned int> numbers_of_faces(const CrackNetwork &network)
    {
      std::vector<unsigned int> result(network.points.size(), 0);
      for (const auto &face : network.faces)
        for (const unsigned int v : face)
          ++result[v];
      return result;
    }

    /** At least as many faces meet there as at the end of a mean face. */
    std::vector<unsigned int> junctions(const CrackNetwork &network)
    {
      const std::vector<unsigned int> n_faces = numbers_of_faces(network);
      double squares = 0.;
      for (const unsigned int n : n_faces)
        squares += double(n) * n;
      const double least =
          std::floor(squares / (2. * double(network.faces.size())));
      std::vector<unsigned int> result;
      for (unsigned int v = 0; v < n_faces.size(); ++v)
        if (n_faces[v] >= least)
          result.push_back(v);
      return result;
    }

    /** Finds junctions by their place. */
    class Places
    {
    public:
      Places(const CrackNetwork &network,
             const std::vector<unsigned int> &junctions, const double width)
          : points_(network.points), width_(width)
      {
        for (const unsigned int v : junctions) {
          at_[key(points_[v], 0, 0)].push_back(v);
          for (unsigned int d = 0; d < 2; ++d) {
            lower_[d] = std::min(lower_[d], points_[v][d]);
            upper_[d] = std::max(upper_[d], points_[v][d]);
          }
        }
      }

      /** A random pair that is @p way apart, none: false. */
      bool draw(const NetworkPoint &way, const std::uint64_t seed,
                std::array<unsigned int, 2> &pair) const
      {
        NetworkPoint from{}, to{};
        for (unsigned int d = 0; d < 2; ++d) {
          const double room = upper_[d] - lower_[d] - std::abs(way[d]);
          from[d] = lower_[d] - std::min(0., way[d]) +
                    std::max(0., room) * uniform(seed, d);
          to[d] = from[d] + way[d];
        }
        return find(from, pair[0]) && find(to, pair[1]) && pair[0] != pair[1];
      }

      double smallest_extent() const
      {
        return std::min(upper_[0] - lower_[0], upper_[1] - lower_[1]);
      }

    private:
      /** The nearest one within the width. */
      bool find(const NetworkPoint &place, unsigned int &v) const
      {
        double least = width_;
        for (int i = -1; i <= 1; ++i)
          for (int j = -1; j <= 1; ++j) {
            const auto found = at_.find(key(place, i, j));
            if (found == at_.end())
              continue;
            for (const unsigned int w : found->second)
              if (distance_of(points_[w], place) < least) {
                least = distance_of(points_[w], place);
                v = w;
              }
          }
        return least < width_;
      }

      std::uint64_t key(const NetworkPoint &p, const int i, const int j) const
      {
        const auto whole = [&](const double x, const int shift) {
          return std::uint64_t(std::int64_t(std::floor(x / width_)) + shift);
        };
        return mixed(mixed(whole(p[0], i)) ^ whole(p[1], j));
      }

      const std::vector<NetworkPoint> &points_;
      double width_;
      NetworkPoint lower_ = {{1e300, 1e300}}, upper_ = {{-1e300, -1e300}};
      std::unordered_map<std::uint64_t, std::vector<unsigned int>> at_;
    };
  } // namespace

  PathRatio path_ratio(const CrackNetwork &network,
                       const unsigned int n_directions,
                       const unsigned int n_pairs)
  {
    PathRatio result;
    if (network.faces.empty())
      return result;
    const std::vector<unsigned int> ends = junctions(network);
    result.spacing = std::sqrt(network.area / double(ends.size()));
    const Places places(network, ends, result.spacing);
    constexpr double n_spacings = 43.;
    // near its sides a mesh is another one
    constexpr double most = .8;
    result.distance =
        std::min(n_spacings * result.spacing, most * places.smallest_extent());

    const Graph graph = graph_of(network);
    std::vector<double> distances(network.points.size());
    double sum = 0., variances = 0.;
    for (unsigned int i = 0; i < n_directions; ++i) {
      constexpr double pi = 3.14159265358979323846;
      const double angle = pi * (i + .5) / n_directions;
      const NetworkPoint way = {{result.distance * std::cos(angle),
                                 result.distance * std::sin(angle)}};
      PathRatio::Direction direction{angle * 180. / pi, 0., 0., 0};
      double own_sum = 0., squares = 0.;
      constexpr unsigned int patience = 20; // where the mesh has holes
      for (unsigned int k = 0;
           k < patience * n_pairs && direction.n_pairs < n_pairs; ++k) {
        std::array<unsigned int, 2> pair{};
        if (!places.draw(way, mixed(i) + k, pair))
          continue;
        const double ratio =
            shortest_way(graph, pair[0], pair[1], distances) /
            distance_of(network.points[pair[0]], network.points[pair[1]]);
        // no way, or one round a hole
        constexpr double detour = 2.;
        if (!(ratio < detour))
          continue;
        ++direction.n_pairs;
        own_sum += ratio;
        squares += ratio * ratio;
      }
      if (direction.n_pairs == 0)
        continue;
      const double n = direction.n_pairs;
      direction.mean = own_sum / n;
      const double variance =
          std::max(0., squares / n - direction.mean * direction.mean);
      direction.scatter = std::sqrt(variance);
      result.directions.push_back(direction);
      result.n_pairs += direction.n_pairs;
      sum += own_sum;
      variances += n * variance;
    }
    if (result.n_pairs > 0) {
      const double n = result.n_pairs;
      result.mean = sum / n;
      result.error = std::sqrt(variances) / n;
    }
    return result;
  }
} // namespace nsfd
