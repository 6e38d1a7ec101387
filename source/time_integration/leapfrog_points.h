#pragma once

#include "active_nodes.h"
#include "common_balance.h"
#include "rigid_groups.h"

#include "nonsmooth/node/node_solver.h"
#include "nonsmooth/one_step_problem.h"

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace nsfd
{
  class Archive;
  struct SceneInput;
  template <int dim>
  class RigidGroups;

  /**
   * The points of released faces, and of obstacles, in the steps of
   * Leapfrog.
   *
   * For solve_point() the step of a chain has the length H = h_last + h and
   * theta = h / H. Contact holds at position level: u_N,k+1 >= 0, which takes
   * no energy and does not drift; at velocity level where there is restitution.
   * In the first step h_last is h, but the law comes from closed faces: its
   * half of a kick has the traction 2 Pi(u_1) / d_1^2 u_1, that of the end of
   * the step for a spring, whose work against a body at rest, whose velocity
   * has half of its change in the middle of the kick, is Pi(u_1).
   */
  template <int dim>
  class LeapfrogPoints
  {
  public:
    /** @p all are the constant data of the points of the mesh. */
    LeapfrogPoints(const Discretization<dim> &discretization,
                   const JoinedMesh<dim> &mesh, const OneStepProblem<dim> &all);

    using Factors = typename LeapfrogChains<dim>::Factors;
    /** See LeapfrogChains. */
    void add(unsigned int point, const Factors &factors, const State &state);
    void release(unsigned int point, const Factors &factors);
    /** Friction at @p temperatures (K) of the points of the mesh; laws that
        have not opened have @p factors of points now. */
    void warm(const std::vector<double> &temperatures,
              const std::function<Factors(unsigned int point)> &factors);
    /** After all that are add()ed: see ActiveNodes. */
    void sort() { nodes_.sort(1., chains_); }

    using AxesOf =
        std::function<std::array<double, dim * dim>(std::size_t point)>;
    /** The faces have turned: rows n, t1, t2 of points of the mesh. Returns how
        much more energy each that counts here stores along them, J, see
        LeapfrogChains. Where @p rigid bodies have turned (null: there are
       none), velocities are those of other places. */
    std::vector<double> turn(const AxesOf &axes_of,
                             const RigidGroups<dim> *rigid,
                             const CornerGroups<dim> &groups);
    /** A point of the mesh is separated, or has slid off what it was joined
        with: others look for what it touches. */
    void part(unsigned int point);

    /** Stored in them at the start, J. Collective. */
    double initial_energy(const Communicator &communicator) const;

    struct Outcome {
      bool converged = true;
      double residual = 0.;
      unsigned int sweeps = 0, newton = 0, problems = 0;
      unsigned int inexact = 0; ///< problems not solved to round-off
      unsigned int held = 0;    ///< solved with HeldNodes
      double excess = 0.;    ///< of what these hold over the strength, less 1
      std::size_t worst = 0; ///< point of the mesh
      const char *impossible = nullptr; ///< why no step goes on from here
    };
    /**
     * The problems of all nodes, from the velocities of the groups without
     * impulses to those with them. @p last is the length of the step before,
     * 0 if there was none; @p prescribed: bit c of a group, component c. What
     * is not solved to round-off counts as solved below @p tolerance. Nodes
     * that are @p apart (ascending) are left.
     */
    Outcome solve(double time_step, double last,
                  const std::vector<std::uint8_t> &prescribed, double tolerance,
                  CornerGroups<dim> &groups,
                  const std::vector<std::size_t> &apart = {});
    /** Contacts of surfaces, and the nodes with points that have groups in
        common with them: one problem. */
    struct Cluster {
      struct Contact {
        std::vector<std::pair<unsigned int, double>> ends; ///< group, share
        std::vector<RigidShare<dim>> bodies;
        std::array<double, dim * dim> frame;
        unsigned int interaction;
        double target; ///< of U_N
        /// friction opposes U_T and this; impulse: in and out
        std::array<double, dim> offset, impulse;
      };
      std::vector<std::size_t> nodes; ///< of the mesh
      std::vector<Contact> contacts;
    };
    /** One that solve() has left; velocities as there. Adds to @p outcome, and
        to @p of_bodies, the free unknowns of the @p rigid bodies (null: there
        are none), which are those of no other one. */
    void solve_cluster(Cluster &cluster,
                       const std::vector<std::uint8_t> &prescribed,
                       double tolerance, RigidGroups<dim> *rigid,
                       std::vector<double> &of_bodies,
                       CornerGroups<dim> &groups, Outcome &outcome);
    /** Then those at @p rigid bodies, which solve() leaves: if these are free,
        all in one, see CoupledNodes. Adds to @p outcome: two of them, or
        one and an obstacle, do not touch. Collective. */
    void solve_rigid(double tolerance, const Communicator &communicator,
                     RigidGroups<dim> &rigid, CornerGroups<dim> &groups,
                     Outcome &outcome);

    /** What the points did in the step that was solved: sums over them, J. */
    struct Balance {
      double stored = 0.; ///< change
      double damage = 0., friction = 0., positive_friction = 0., impact = 0.,
             numerical = 0., viscous = 0.;
      double broken = 0.;      ///< area, m^2 or m
      double penetration = 0.; ///< beyond overlaps of released springs, m
      double way = 0.;         ///< of two sides that touch, in the step, m
      unsigned int active = 0;
      bool beyond_unique = false;
      LineChanges changes; ///< of friction, damage, impact, numerical
      /// of a scene with heat: points of the mesh, J by damage and friction
      std::vector<std::pair<unsigned int, double>> heat;
    };
    /** Balances the step; what the points keep does not change. Collective. */
    Balance account(const Communicator &communicator);
    /**
     * The balanced step is taken: jumps and histories move on. True if a face
     * has lost its last hold.
     */
    bool accept();

    /** Impulse of @p groups beside a prescribed motion: all that points gave in
        the last solve, x, y, z. */
    void add_impulses(const std::vector<int> &row_of_group,
                      std::vector<double> &rows) const;

    const LeapfrogChains<dim> &chains() const { return chains_; }
    /** The chain that is not shown, of points that have been add()ed. */
    void serialize(Archive &archive);

  private:
    using Node = ActiveNode<dim>;

    void set_point(unsigned int a);
    bool solve_loose(Node &node);
    bool solve_elastic(Node &node);
    void account_point(unsigned int a, std::size_t row, Balance &balance);
    void account_spring(unsigned int a, std::size_t row, Balance &balance);
    void keep_jump(unsigned int a, bool held);
    void keep(unsigned int a, const PointEnergies<dim> &energies);
    void begin(const Node &node);
    void solve_node(Node &node, double tolerance, CornerGroups<dim> &groups,
                    Outcome &outcome);

    const Discretization<dim> &discretization_;
    const JoinedMesh<dim> &mesh_;
    const OneStepProblem<dim> &all_;

    LeapfrogChains<dim> chains_;
    /// by face: chains of its points that are not broken
    std::vector<unsigned int> hold_of_face_;
    bool separates_ = false; ///< in accept()
    const bool heals_;       ///< some law does

    ActiveNodes<dim> nodes_;
    std::vector<unsigned int> moved_;  ///< points of the step, nodes in order
    std::vector<std::uint8_t> counts_; ///< of these, see JoinedMesh
    std::vector<unsigned int> parted_; ///< others: broken and apart
    NodeSolver<dim> solver_;
    unsigned int chain_ = 0;                       ///< which one is in the step
    std::array<std::array<double, 2>, 2> steps_{}; ///< H and theta, by chain
    std::vector<std::array<double, dim>> free_;    ///< of the groups
    std::vector<double> terms_;
    /// of the step, as `moved_`; springs of an ElasticNode, else null
    std::vector<const typename ElasticNode<dim>::Point *> springs_;
    std::vector<PointEnergies<dim>> energies_;
  };
} // namespace nsfd
