#pragma once

#include "delassus/velocity_solver.h"
#include "nonsmooth/node/node_solver.h"

namespace nsfd
{
  /**
   * Nonlinear elimination (Lanzkron, Rose & Wilkes 1996): where Newton's method
   * for all points goes round among the few that stick, slide, soften or close
   * at one vertex, these are solved by themselves, with all other nodes as they
   * are, and Newton's method goes on from there.
   */
  template <int dim>
  class VertexElimination
  {
  public:
    /**
     * The vertices of these @p points of this rank, where these see no node of
     * another vertex: impulses of all points there, and @p w of its nodes, see
     * NodeMotion::motion(). @p U are the velocities under w. False if nothing
     * was solved on any rank. Collective.
     */
    bool solve(const OneStepProblem<dim> &problem, VertexMotion<dim> &motion,
               const Communicator &communicator,
               const std::vector<std::size_t> &points,
               const std::vector<double> &U, std::vector<double> &w,
               std::vector<double> &impulse);

  private:
    bool set_problem(const NodeClusters::Cluster &vertex,
                     const std::vector<int> &place,
                     const VertexMotion<dim> &motion,
                     const std::vector<double> &U,
                     const std::vector<double> &impulse);

    NodeSolver<dim> solver_;
    NodeProblem<dim> node_;
    std::vector<PointEnds> ends_;
    std::vector<double> frames_; ///< points see what is in their own axes
    std::vector<LocalSolution<dim>> solutions_;
    std::vector<double> trial_;
    std::vector<int> seen_;
    std::vector<std::array<double, std::size_t(dim) * dim>> B_;
  };
} // namespace nsfd
