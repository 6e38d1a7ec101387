#pragma once

#include "core/disjoint_sets.h"

#include <cstddef>
#include <vector>

namespace nsfd
{
  /**
   * Nodes that points couple, directly or through others, in groups of their
   * own: of points at nodes, the nodes that lie at one vertex of the mesh.
   */
  class NodeClusters
  {
  public:
    /// unknowns of a cluster: beyond, a sparse factor is cheaper
    static constexpr std::size_t largest = 192;

    struct Cluster {
      std::vector<int> nodes;          ///< ascending
      std::vector<std::size_t> points; ///< ascending
      std::vector<double> inverse;     ///< row by row; empty: there is none
    };

    NodeClusters() = default;
    /**
     * Of nodes 0 to @p n_nodes - 1 with @p size unknowns each; @p n_points
     * points, of which each couples the nodes seen(point). No cluster has a
     * node that is @p excluded.
     */
    template <typename Seen>
    NodeClusters(std::size_t n_nodes, unsigned int size, std::size_t n_points,
                 const Seen &seen, const std::vector<char> &excluded);

    std::vector<Cluster> clusters;
    std::vector<int> of_point; ///< -1: none
    std::vector<int> place;    ///< of a node in its cluster
    std::vector<char> covers; ///< by point: it is in a cluster, or sees nothing
  };

  template <typename Seen>
  NodeClusters::NodeClusters(const std::size_t n_nodes, const unsigned int size,
                             const std::size_t n_points, const Seen &seen,
                             const std::vector<char> &excluded)
      : of_point(n_points, -1), place(n_nodes, -1), covers(n_points, 1)
  {
    DisjointSets sets(n_nodes);
    std::vector<char> is_seen(n_nodes, 0);
    for (std::size_t i = 0; i < n_points; ++i) {
      const auto &nodes = seen(i);
      for (const int node : nodes) {
        is_seen[std::size_t(node)] = 1;
        sets.join(unsigned(nodes.front()), unsigned(node));
      }
    }
    // by the first node of a set
    std::vector<std::size_t> count(n_nodes, 0);
    std::vector<char> is_out(n_nodes, 0);
    for (std::size_t k = 0; k < n_nodes; ++k)
      if (is_seen[k]) {
        const std::size_t first = sets.first(unsigned(k));
        ++count[first];
        is_out[first] = is_out[first] || excluded[k];
      }
    std::vector<int> number(n_nodes, -1);
    for (std::size_t k = 0; k < n_nodes; ++k) {
      const std::size_t first = sets.first(unsigned(k));
      if (!is_seen[k] || is_out[first] || count[first] * size > largest)
        continue;
      if (first == k) {
        number[k] = int(clusters.size());
        clusters.emplace_back();
      }
      auto &nodes = clusters[std::size_t(number[first])].nodes;
      place[k] = int(nodes.size());
      nodes.push_back(int(k));
    }
    for (std::size_t i = 0; i < n_points; ++i) {
      const auto &nodes = seen(i);
      if (nodes.empty())
        continue;
      of_point[i] = number[sets.first(unsigned(nodes.front()))];
      covers[i] = of_point[i] >= 0;
      if (covers[i])
        clusters[std::size_t(of_point[i])].points.push_back(i);
    }
  }
} // namespace nsfd
