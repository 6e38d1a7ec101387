#include "active_nodes.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  ActiveNodes<dim>::ActiveNodes(const JoinedMesh<dim> &mesh)
      : mesh_(mesh), index_(mesh.n_nodes(), -1)
  {
  }

  /** In the order of the mesh. */
  template <int dim>
  void ActiveNodes<dim>::put(const std::vector<unsigned int> &points)
  {
    const auto a = unsigned(points.size() - 1);
    const std::size_t node = mesh_.node_of_point(points[a]);
    if (index_[node] < 0) {
      index_[node] = int(nodes_.size());
      nodes_.emplace_back().node = node;
    }
    Node &here = of(node);
    here.is_new = true;
    here.points.insert(
        std::lower_bound(here.points.begin(), here.points.end(), a,
                         [&](const unsigned int one, const unsigned int two) {
                           return points[one] < points[two];
                         }),
        a);
  }

  /** The problem of a node: its points between two groups. */
  template <int dim>
  void ActiveNodes<dim>::collect(Node &node,
                                 const std::vector<std::uint8_t> &prescribed,
                                 const CornerGroups<dim> &groups,
                                 LeapfrogChains<dim> &chains) const
  {
    NodeProblem<dim> &problem = node.problem;
    problem.clear();
    node.groups.clear();
    node.is_new = node.is_rigid = node.is_driven = false;
    node.settled = 0;
    for (auto &elastic : node.elastic)
      elastic.is_new = true;
    const auto local = [&](const unsigned int corner) {
      if (corner == JoinedMesh<dim>::none)
        return -1;
      const unsigned int group = groups.of(corner);
      const auto found =
          std::find(node.groups.begin(), node.groups.end(), group);
      const auto at = int(found - node.groups.begin());
      if (found == node.groups.end()) {
        node.groups.push_back(group);
        std::array<double, dim> inverse;
        for (unsigned int c = 0; c < dim; ++c)
          inverse[c] = prescribed[group] & (1u << c)
                           ? 0.
                           : groups.inverse_mass(group, c);
        problem.inverse_mass.push_back(inverse);
        node.is_rigid |= (prescribed[group] & (1u << dim)) != 0;
        node.is_driven |= prescribed[group] != 0;
      }
      return at;
    };
    for (const unsigned int a : node.points) {
      if (chains.problem.kind[a] == PointKind::separated)
        continue;
      const auto &corners = mesh_.corners(chains.point[a]);
      if (corners[0] != JoinedMesh<dim>::none &&
          corners[1] != JoinedMesh<dim>::none &&
          groups.of(corners[0]) == groups.of(corners[1]))
        continue;
      const int one = local(corners[0]), two = local(corners[1]);
      problem.points.push_back({a, {{one, two}}});
      double flexibility = 0.;
      for (const int group : {one, two})
        if (group >= 0) {
          const auto &inverse = problem.inverse_mass[std::size_t(group)];
          flexibility += *std::max_element(inverse.begin(), inverse.end());
        }
      chains.problem.majorant_normal[a] = flexibility;
    }
    problem.velocity.resize(node.groups.size());
  }

  template <int dim>
  void ActiveNodes<dim>::sort(const double growth, LeapfrogChains<dim> &chains)
  {
    if (double(chains.size()) < growth * double(n_sorted_))
      return;
    n_sorted_ = chains.size();
    std::sort(
        nodes_.begin(), nodes_.end(),
        [](const Node &one, const Node &two) { return one.node < two.node; });
    std::vector<unsigned int> order;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      Node &node = nodes_[k];
      index_[node.node] = int(k);
      node.is_new = true;
      for (unsigned int &a : node.points) {
        order.push_back(a);
        a = unsigned(order.size() - 1);
      }
    }
    chains.reorder(order);
  }

  template class ActiveNodes<2>;
  template class ActiveNodes<3>;
} // namespace nsfd
