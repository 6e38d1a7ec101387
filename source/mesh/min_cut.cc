#include "min_cut.h"

#include "nsfd/core/space.h"

#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <boost/graph/compressed_sparse_row_graph.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    using namespace space;

    struct FlowWay {
      double capacity;
      std::size_t number; ///< that of the way back differs in the last bit
    };
    using FlowGraph =
        boost::compressed_sparse_row_graph<boost::directedS, boost::no_property,
                                           FlowWay>;
    using FlowEdge = boost::graph_traits<FlowGraph>::edge_descriptor;

    struct SpaceBox {
      Vec3 lower, upper;

      bool contains(const Vec3 &p) const
      {
        for (unsigned int d = 0; d < 3; ++d)
          if (p[d] < lower[d] || p[d] > upper[d])
            return false;
        return true;
      }
    };

    /** What lies in a box in the middle of the network. */
    CellNetwork part_of(const CellNetwork &network, const double share)
    {
      CellNetwork part;
      for (unsigned int d = 0; d < 3; ++d) {
        const double middle = .5 * (network.lower[d] + network.upper[d]),
                     half = .5 * share * (network.upper[d] - network.lower[d]);
        part.lower[d] = middle - half;
        part.upper[d] = middle + half;
      }
      const SpaceBox box{part.lower, part.upper};
      constexpr unsigned int none = std::numeric_limits<unsigned int>::max();
      std::vector<unsigned int> number(network.centres.size(), none);
      for (std::size_t c = 0; c < network.centres.size(); ++c)
        if (share == 1. || box.contains(network.centres[c])) {
          number[c] = unsigned(part.centres.size());
          part.centres.push_back(network.centres[c]);
          part.is_at_boundary.push_back(network.is_at_boundary[c]);
        }
      for (const CellNetwork::Face &face : network.faces) {
        const unsigned int a = number[face.first], b = number[face.second];
        if (a != none && b != none)
          part.faces.push_back({a, b, face.area, face.may_break});
        else if (a != none)
          part.is_at_boundary[a] = true;
        else if (b != none)
          part.is_at_boundary[b] = true;
      }
      return part;
    }

    /** Of the plane through the middle of the box, in it. */
    double area_of_plane(const SpaceBox &box, const Vec3 &normal)
    {
      const Vec3 other =
          std::abs(normal[0]) < .9 ? Vec3{{1., 0., 0.}} : Vec3{{0., 1., 0.}};
      Vec3 u = space::cross(normal, other);
      u = (1. / norm(u)) * u;
      const Vec3 v = space::cross(normal, u),
                 middle = .5 * (box.lower + box.upper);
      const double far = 2. * norm(box.upper - box.lower);
      std::vector<Vec3> polygon = {
          middle + far * (u + v), middle + far * (v - u),
          middle - far * (u + v), middle + far * (u - v)};
      for (unsigned int d = 0; d < 3; ++d)
        for (const double sign : {-1., 1.}) {
          const double level = sign * (sign > 0. ? box.upper : box.lower)[d];
          std::vector<Vec3> clipped;
          for (std::size_t i = 0; i < polygon.size(); ++i) {
            const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
            const double f = sign * a[d] - level, g = sign * b[d] - level;
            if (f <= 0.)
              clipped.push_back(a);
            if ((f < 0. && g > 0.) || (f > 0. && g < 0.))
              clipped.push_back(a + (f / (f - g)) * (b - a));
          }
          polygon = clipped;
        }
      Vec3 sum{};
      for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
        sum = sum + space::cross(polygon[i] - polygon[0],
                                 polygon[i + 1] - polygon[0]);
      return .5 * norm(sum);
    }

    /** Ways there and back between the cells, a source and a sink. */
    FlowGraph flow_graph(const CellNetwork &network, const Vec3 &normal)
    {
      const std::size_t n = network.centres.size();
      std::vector<std::pair<std::size_t, std::size_t>> ways;
      std::vector<FlowWay> capacities;
      const auto add = [&](const std::size_t a, const std::size_t b,
                           const double there, const double back) {
        ways.emplace_back(a, b);
        ways.emplace_back(b, a);
        capacities.push_back({there, capacities.size()});
        capacities.push_back({back, capacities.size()});
      };
      double all = 0.;
      for (const CellNetwork::Face &face : network.faces)
        all += face.area;
      for (const CellNetwork::Face &face : network.faces) {
        const double area = face.may_break ? face.area : all;
        add(face.first, face.second, area, area);
      }
      const Vec3 middle = .5 * (network.lower + network.upper);
      for (std::size_t c = 0; c < n; ++c)
        if (network.is_at_boundary[c]) {
          if (dot(network.centres[c] - middle, normal) > 0.)
            add(n, c, all, 0.);
          else
            add(c, n + 1, all, 0.);
        }
      return FlowGraph(boost::edges_are_unsorted_multi_pass, ways.begin(),
                       ways.end(), capacities.begin(), n + 2);
    }

    double smallest_cut(const CellNetwork &network, const Vec3 &normal)
    {
      const FlowGraph graph = flow_graph(network, normal);
      const std::size_t n = num_vertices(graph), n_edges = num_edges(graph);
      std::vector<FlowEdge> by_number(n_edges), reverse(n_edges),
          predecessor(n);
      std::vector<double> residual(n_edges);
      std::vector<boost::default_color_type> colour(n);
      std::vector<long> distance(n);
      const auto [first, last] = edges(graph);
      for (auto edge = first; edge != last; ++edge)
        by_number[graph[*edge].number] = *edge;
      const auto index = get(boost::edge_index, graph);
      for (auto edge = first; edge != last; ++edge)
        reverse[get(index, *edge)] = by_number[graph[*edge].number ^ 1u];
      const auto of_edges = [&](auto &values) {
        return boost::make_iterator_property_map(values.begin(), index);
      };
      const auto vertex = get(boost::vertex_index, graph);
      const auto of_vertices = [&](auto &values) {
        return boost::make_iterator_property_map(values.begin(), vertex);
      };
      return boost::boykov_kolmogorov_max_flow(
          graph, get(&FlowWay::capacity, graph), of_edges(residual),
          of_edges(reverse), of_vertices(predecessor), of_vertices(colour),
          of_vertices(distance), vertex, n - 2, n - 1);
    }

    /**
     * The value at 0 of the straight line through the points; what a box says
     * weighs as much as its faces are many.
     */
    double at_zero(const std::vector<double> &x, const std::vector<double> &y)
    {
      double n = 0., sx = 0., sy = 0., sxx = 0., sxy = 0.;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double weight = 1. / (x[i] * x[i]);
        n += weight;
        sx += weight * x[i];
        sy += weight * y[i];
        sxx += weight * x[i] * x[i];
        sxy += weight * x[i] * y[i];
      }
      return (sxx * sy - sx * sxy) / (n * sxx - sx * sx);
    }
  } // namespace

  CutRatio cut_ratio(const CellNetwork &network,
                     const unsigned int n_directions)
  {
    CutRatio result;
    const std::vector<double> shares = {1. / 3., 2. / 3., 1.};
    std::vector<CellNetwork> parts;
    std::vector<double> inverse;
    for (const double share : shares) {
      parts.push_back(part_of(network, share));
      inverse.push_back(1. / share);
    }
    result.mean = result.in_this_box = 0.;
    for (unsigned int i = 0; i < n_directions; ++i) {
      // a spiral from the pole to the equator, by the golden angle
      constexpr double golden = 2.39996322972865332;
      const double z = (i + .5) / n_directions, r = std::sqrt(1. - z * z);
      const Vec3 normal = {
          {r * std::cos(golden * i), r * std::sin(golden * i), z}};
      std::vector<double> ratios;
      for (const CellNetwork &part : parts)
        ratios.push_back(smallest_cut(part, normal) /
                         area_of_plane({part.lower, part.upper}, normal));
      result.directions.push_back({normal, at_zero(inverse, ratios)});
      result.mean += result.directions.back().ratio / n_directions;
      result.in_this_box += ratios.back() / n_directions;
    }
    return result;
  }
} // namespace nsfd
