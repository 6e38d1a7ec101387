#pragma once

#include <algorithm>
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

  private:
    static int root_of(std::vector<int> &parent, int node);
  };

  inline int NodeClusters::root_of(std::vector<int> &parent, int node)
  {
    while (parent[std::size_t(node)] != node)
      node = parent[std::size_t(node)] =
          parent[std::size_t(parent[std::size_t(node)])];
    return node;
  }

  template <typename Seen>
  NodeClusters::NodeClusters(const std::size_t n_nodes, const unsigned int size,
                             const std::size_t n_points, const Seen &seen,
                             const std::vector<char> &excluded)
      : of_point(n_points, -1), place(n_nodes, -1), covers(n_points, 1)
  {
    std::vector<int> parent(n_nodes);
    for (std::size_t k = 0; k < n_nodes; ++k)
      parent[k] = int(k);
    std::vector<char> is_seen(n_nodes, 0);
    for (std::size_t i = 0; i < n_points; ++i) {
      int first = -1;
      for (const int node : seen(i)) {
        is_seen[std::size_t(node)] = 1;
        // the lower number is the root: the same clusters in any order
        const int mine = root_of(parent, node);
        if (first < 0)
          first = mine;
        const int low = std::min(first, mine), high = std::max(first, mine);
        parent[std::size_t(high)] = low;
        first = low;
      }
    }
    std::vector<std::size_t> count(n_nodes, 0);
    std::vector<char> is_out(n_nodes, 0);
    for (std::size_t k = 0; k < n_nodes; ++k)
      if (is_seen[k]) {
        const auto root = std::size_t(root_of(parent, int(k)));
        ++count[root];
        is_out[root] = is_out[root] || excluded[k];
      }
    std::vector<int> number(n_nodes, -1); // by root
    for (std::size_t k = 0; k < n_nodes; ++k) {
      const auto root = std::size_t(root_of(parent, int(k)));
      if (!is_seen[k] || is_out[root] || count[root] * size > largest)
        continue;
      if (number[root] < 0) {
        number[root] = int(clusters.size());
        clusters.emplace_back();
      }
      auto &nodes = clusters[std::size_t(number[root])].nodes;
      place[k] = int(nodes.size());
      nodes.push_back(int(k));
    }
    for (std::size_t i = 0; i < n_points; ++i) {
      const auto &nodes = seen(i);
      if (nodes.empty())
        continue;
      of_point[i] = number[std::size_t(root_of(parent, nodes.front()))];
      covers[i] = of_point[i] >= 0;
      if (covers[i])
        clusters[std::size_t(of_point[i])].points.push_back(i);
    }
  }
} // namespace nsfd
