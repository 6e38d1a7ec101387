#pragma once

#include "node_system.h"

namespace nsfd
{
  /** How far the problem of a node was solved, and what it has cost. */
  struct NodeReport {
    bool converged = true;
    double residual = 0.;         ///< relative natural map, see natural_map.h
    unsigned int sweeps = 0;      ///< of Gauss-Seidel
    unsigned int newton = 0;      ///< linear systems
    unsigned int evaluations = 0; ///< of the natural map
    unsigned int starts = 0;      ///< beyond the first
  };

  /**
   * The local problem of a node in a step of joined cells: U = U_free + W P, -P
   * in the law of every point, W from the masses of the groups.
   *
   * A semismooth Newton method from the impulses of the last step solves nearly
   * all, most in one step. Where points of a cycle hold each other more than
   * they can, what is left over does not change until one of them is released:
   * softened directions go there at an equal error. What stalls is reached by
   * softer laws (NodePath). What is left is swept and begun again from other
   * impulses, drawn from the number of the attempt: the result depends on
   * nothing but the problem.
   *
   * Where the traction drops to nothing at the end of a law (brittle, dugdale)
   * a problem may have no solution: the point can neither stay nor go. Then
   * the best impulses found are given, and the report says so.
   *
   * The memory is kept from problem to problem.
   */
  template <int dim>
  class NodeSolver
  {
  public:
    static constexpr double aim = 1e-13;     ///< of the relative natural map
    static constexpr double control = 9e-13; ///< what round-off may leave

    /**
     * Impulses (dim per point of the problem, local frame, N s) are the start
     * and the solution. @p frames: dim * dim per point, rows n, t1, t2. Of
     * @p solutions those of the points of the node are set. The first
     * attempt that comes to rest at a residual below a tenth of @p enough, or a
     * later one below all of it, is the last.
     */
    NodeReport solve(const OneStepProblem<dim> &problem,
                     const std::vector<double> &frames, NodeProblem<dim> &node,
                     std::vector<double> &impulses,
                     std::vector<LocalSolution<dim>> &solutions,
                     double enough = 0.);

    /** Of the problem that was solved last: see NodeSystem. */
    bool respond(const std::vector<int> &groups, std::vector<double> &response)
    {
      return system_.respond(groups, response);
    }

  private:
    NodeSystem<dim> system_;
    NodeReport report_;
    double error_ = 0., best_ = 0., soft_ = 0., enough_ = 0.;
    unsigned int flat_moves_ = 0;

    bool run();
    bool is_solved();
    bool improve();
    bool accepts(double length, bool first);
    bool follow();
    void start_again();
    double evaluate();
  };
} // namespace nsfd
