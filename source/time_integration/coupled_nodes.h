#pragma once

#include "leapfrog_chains.h"
#include "rigid_groups.h"

#include "core/order_free_sum.h"
#include "nonsmooth/node/node_solver.h"

namespace nsfd
{
  /**
   * Problems of nodes at rigid bodies that are free in some of their motions.
   * With y these unknowns of all bodies, each node has a problem of its own for
   * given y, in which the motion of the bodies is prescribed, and its impulses
   * answer to it:
   *
   *   y = E^T R^T P(R (V + E y)),
   *
   * which is solved by Newton's method, to round-off. All ranks solve it alike.
   */
  template <int dim>
  class CoupledNodes
  {
  public:
    struct Node {
      NodeProblem<dim> *problem;
      const std::vector<unsigned int> *groups; ///< of the problem
      bool counts;                             ///< on this rank
    };
    struct Report {
      bool converged = true;
      double residual = 0.;
      unsigned int sweeps = 0, newton = 0; ///< at nodes that count
      unsigned int inexact = 0;            ///< nodes that are not solved
      unsigned int rounds = 0;
      std::size_t worst = 0; ///< point of `chains`
    };

    CoupledNodes(const Communicator &communicator, RigidGroups<dim> &rigid,
                 NodeSolver<dim> &solver, LeapfrogChains<dim> &chains,
                 CornerGroups<dim> &groups, std::vector<Node> nodes);

    /** From the velocities of the groups without impulses to those with them.
        Collective. */
    Report solve();

  private:
    /// of the impulses: what the nodes leave
    static constexpr double aim = NodeSolver<dim>::control;
    static constexpr unsigned int most_rounds = 60;

    /** A group of a rigid body at a node. */
    struct Place {
      int local; ///< in the problem
      unsigned int group;
      std::size_t first; ///< free unknown
      std::vector<std::array<double, dim>> columns;
    };
    struct Start {
      std::vector<std::array<double, dim>> velocity;
      std::vector<Place> places;
    };

    std::array<double, dim> impulse_on(const Node &node, int local) const;
    void add_impulses(std::size_t k);
    void add_response(std::size_t k);
    double evaluate(const std::vector<double> &y);
    bool advance(std::vector<double> &y);

    const Communicator &communicator_;
    RigidGroups<dim> &rigid_;
    NodeSolver<dim> &solver_;
    LeapfrogChains<dim> &chains_;
    CornerGroups<dim> &groups_;
    const std::vector<Node> nodes_;
    std::vector<Start> starts_;

    Report report_;
    std::size_t n_;
    double floor_, scale_ = 0., error_ = 0.;
    std::vector<OrderFreeSum> own_; ///< E^T R^T P, its sizes, and derivative
    std::vector<double> sums_, response_;
  };
} // namespace nsfd
