#pragma once

#include "delassus/delassus_operator.h"
#include "discretization/point_places.h"
#include "linear_algebra/dense_lu.h"
#include "nonsmooth/one_step_problem.h"

#include <array>
#include <vector>

namespace nsfd
{
  /** All components of the point are prescribed. */
  template <int dim>
  bool is_held(const OneStepProblem<dim> &problem, const std::size_t point)
  {
    return problem.kind[point] == PointKind::prescribed &&
           problem.mask[point] == (1u << dim) - 1u;
  }

  /**
   * Unknowns of bodies apart that joints make one. A face whose points are all
   * held in all components holds the nodes of its two sides together, if these
   * are at the same places: then what one side moves at the points the other
   * one does as well, node by node, and the rows of the face say no more. On
   * one rank.
   */
  template <int dim>
  class TiedNodes
  {
  public:
    /** @p held per point: not zero where all components are prescribed. */
    TiedNodes(const DelassusOperator<dim> &delassus,
              const std::vector<char> &held);

    /** Per point: its face ties all of its nodes. */
    const std::vector<char> &points() const { return points_; }
    bool any() const { return !faces_.empty(); }
    std::size_t n_unknowns() const { return n_unknowns_; }
    /** By unknown of the bodies: the one that is left. */
    const std::vector<int> &unknown() const { return unknown_; }

    /** Forces by unknown of the bodies, summed. */
    void fold(const std::vector<double> &forces,
              std::vector<double> &sums) const;
    /** A motion of the unknowns that are left, by unknown of the bodies. */
    void spread(const std::vector<double> &motion,
                std::vector<double> &all) const;

    /** Velocities by unknown of the bodies whose jumps at tied points are those
        of @p jumps, in local frames, if there are any. */
    std::vector<double> motion_of(const std::vector<double> &jumps) const;
    /**
     * Impulses at the tied points, zero elsewhere, that are as much for the
     * bodies as @p forces, which sum to zero at every unknown that is left:
     * those of least norm, node by node.
     */
    std::vector<double> impulses_of(const std::vector<double> &forces) const;

  private:
    /** A face whose nodes are tied, with the values of its shape functions. */
    struct Face {
      unsigned int first, count;
      std::vector<std::array<int, 2>> nodes; ///< first unknowns, by side
      std::vector<double> inverse; ///< nodes x points: values there to nodes
    };
    /** What is one node of cells, and the faces between them. */
    struct Node {
      std::vector<int> cells; ///< first unknown in each
      struct Link {
        std::size_t face, node; ///< in faces_, and there
        unsigned int from, to;  ///< in cells
      };
      std::vector<Link> links;
      DenseLU laplacian; ///< of the links, the first cell held
    };

    bool match(std::size_t face, Face &result) const;
    void find_nodes();
    void solve(const Node &node, std::vector<double> &right) const;

    const DelassusOperator<dim> &delassus_;
    std::array<std::vector<PointPlace>, 2> places_;
    std::vector<char> points_;
    std::vector<int> unknown_;
    std::size_t n_unknowns_ = 0;
    std::vector<Face> faces_;
    std::vector<Node> nodes_;
  };
} // namespace nsfd
