#pragma once

#include "leapfrog_chains.h"

#include "joined/corner_groups.h"
#include "joined/elastic_node.h"

#include <cstdint>
#include <vector>

namespace nsfd
{
  /** A node of the mesh that has points in the steps of Leapfrog. */
  template <int dim>
  struct ActiveNode {
    std::size_t node;
    std::vector<unsigned int> points; ///< all active ones here
    bool is_new = true;               ///< points or groups have changed
    bool is_rigid = false;            ///< there is a group of a rigid body
    bool is_driven = false;           ///< there is a prescribed motion
    /// the last steps in which its points were springs and none was closed;
    /// 3: and the last one was that of a LooseNode
    std::uint8_t settled = 0;
    NodeProblem<dim> problem;
    std::vector<unsigned int> groups; ///< of the problem
    /// of either chain
    struct Elastic {
      bool is_new = true, exists = false;
      ElasticNode<dim> node;
    };
    std::array<Elastic, 2> elastic;

    /** It is solved soon, in the step of @p chain. */
    void prefetch(const unsigned int chain) const
    {
      nsfd::prefetch(groups);
      nsfd::prefetch(problem.points);
      nsfd::prefetch(problem.inverse_mass);
      nsfd::prefetch(problem.velocity);
      elastic[chain].node.prefetch();
    }
  };

  /** The points of LeapfrogChains by the nodes that they are at. */
  template <int dim>
  class ActiveNodes
  {
  public:
    using Node = ActiveNode<dim>;

    explicit ActiveNodes(const JoinedMesh<dim> &mesh);

    auto begin() { return nodes_.begin(); }
    auto end() { return nodes_.end(); }
    auto begin() const { return nodes_.begin(); }
    auto end() const { return nodes_.end(); }
    /** That of the mesh number @p node, which has points. */
    Node &of(const std::size_t node)
    {
      return nodes_[std::size_t(index_[node])];
    }

    /** The last of @p points (of the mesh) has come. */
    void put(const std::vector<unsigned int> &points);

    /** The problem of a node: its points between two groups. */
    void collect(Node &node, const std::vector<std::uint8_t> &prescribed,
                 const CornerGroups<dim> &groups,
                 LeapfrogChains<dim> &chains) const;

    /**
     * If there are @p growth times as many points as the last time, all go to
     * where their nodes are in the mesh: what a step reads lies together then.
     * Problems are to be collected anew.
     */
    void sort(double growth, LeapfrogChains<dim> &chains);

  private:
    const JoinedMesh<dim> &mesh_;
    std::vector<Node> nodes_;
    std::vector<int> index_;   ///< by node of the mesh, -1: none here
    std::size_t n_sorted_ = 0; ///< points
  };
} // namespace nsfd
