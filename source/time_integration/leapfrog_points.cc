#include "leapfrog_points.h"

#include "nonsmooth/healing.h"

#include "coupled_nodes.h"
#include "point_velocities.h"

#include "discretization/discretization.h"
#include "discretization/point_factors.h"
#include "joined/held_nodes.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace nsfd
{
  namespace
  {
    constexpr long ahead = 3; ///< nodes that are fetched before their turn

    /** False where a point of @p node is closed and rubs. */
    template <int dim>
    bool may_be_elastic(const LeapfrogChains<dim> &chains,
                        const NodeProblem<dim> &node)
    {
      const OneStepProblem<dim> &p = chains.problem;
      for (const auto &place : node.points) {
        const std::size_t a = place.point;
        if (chains.closed[a] &&
            (p.kind[a] == PointKind::free ||
             (p.kind[a] == PointKind::cohesive && chains.beta[a] < 1.)) &&
            p.interactions[p.interaction[a]].friction > 0.)
          return false;
      }
      return true;
    }

    /** Velocities whose squares have lost their digits are none: in front of a
        wave all that a node solves would be made of such squares. Energies do
        not know them. */
    template <int dim>
    void fetch_velocities(const std::vector<unsigned int> &of,
                          const CornerGroups<dim> &groups,
                          NodeProblem<dim> &problem)
    {
      using limits = std::numeric_limits<double>;
      static const double least = std::sqrt(limits::min()) / limits::epsilon();
      for (std::size_t k = 0; k < of.size(); ++k)
        for (unsigned int c = 0; c < dim; ++c) {
          const double v = groups.velocity[of[k] * dim + c];
          problem.velocity[k][c] = std::abs(v) < least ? 0. : v;
        }
    }

    template <int dim>
    void take_held(const HeldNodes<dim> &held, LeapfrogChains<dim> &chains,
                   typename LeapfrogPoints<dim>::Outcome &outcome)
    {
      held.mark(chains.solution);
      outcome.excess = std::max(outcome.excess, held.excess(chains.impulse));
    }

    /** Chains of the points of every face that are not broken. */
    template <int dim>
    std::vector<unsigned int> holds_of_faces(const InterfacePoints<dim> &points,
                                             const LeapfrogChains<dim> &chains)
    {
      std::vector<unsigned int> holds;
      for (const auto &face : points.faces)
        holds.push_back(2 * face.count);
      for (std::size_t a = 0; a < chains.size(); ++a)
        for (const double beta : {chains.beta[a], chains.other.beta[a]})
          if (beta < 1e-3)
            --holds[points.face_of[chains.point[a]]];
      return holds;
    }
  } // namespace

  template <int dim>
  LeapfrogPoints<dim>::LeapfrogPoints(const Discretization<dim> &discretization,
                                      const JoinedMesh<dim> &mesh,
                                      const OneStepProblem<dim> &all)
      : discretization_(discretization), mesh_(mesh), all_(all), chains_(all),
        hold_of_face_(holds_of_faces(discretization.points(), chains_)),
        heals_(has_healing(all)), nodes_(mesh)
  {
  }

  template <int dim>
  void LeapfrogPoints<dim>::add(const unsigned int point,
                                const Factors &factors, const State &state)
  {
    const auto &points = discretization_.points();
    chains_.add(point, points.axes(point), factors, state);
    if (state.beta[point] < 1e-3)
      hold_of_face_[points.face_of[point]] -= 2;
    nodes_.put(chains_.point);
  }

  template <int dim>
  void LeapfrogPoints<dim>::release(const unsigned int point,
                                    const Factors &factors)
  {
    const double *frame = discretization_.points().axes(point);
    // each sort costs some steps: a few in all
    nodes_.sort(1.25, chains_);
    chains_.release(point, frame, factors);
    nodes_.put(chains_.point);
  }

  template <int dim>
  void LeapfrogPoints<dim>::warm(
      const std::vector<double> &temperatures,
      const std::function<Factors(unsigned int point)> &factors)
  {
    OneStepProblem<dim> &p = chains_.problem;
    const auto &input = discretization_.input();
    for (std::size_t a = 0; a < chains_.size(); ++a) {
      const unsigned int point = chains_.point[a];
      const PointOrigin &origin = discretization_.origins()[point];
      if (!p.friction_factor.empty())
        p.friction_factor[a] =
            friction_factor(input, origin, temperatures[point]);
      const bool is_closed = p.kind[a] == PointKind::rigid &&
                             chains_.other.kind[a] == PointKind::rigid &&
                             p.opening_max[a] == 0. &&
                             chains_.other.opening_max[a] == 0.;
      if (!is_closed || !input.interfaces[origin.block].heat.changes_law())
        continue;
      const Factors now = factors(point);
      if (now.strength == p.strength_factor[a] &&
          now.opening == p.opening_factor[a])
        continue;
      p.strength_factor[a] = now.strength;
      p.opening_factor[a] = now.opening;
      for (auto &elastic : nodes_.of(mesh_.node_of_point(point)).elastic)
        elastic.is_new = true;
    }
  }

  /** Of the step that comes: contact. */
  template <int dim>
  void LeapfrogPoints<dim>::set_point(const unsigned int a)
  {
    OneStepProblem<dim> &p = chains_.problem;
    const double h = p.time_step * p.theta;
    p.contact[a] = p.compression_stiffness[a] == 0. && !chains_.is_left(a);
    const double u = p.jump_free[a * dim], U = chains_.old_velocity[a * dim];
    chains_.turned[a] = 0;
    p.target[a] = -(u + chains_.released[a]) / h;
    // as faces turn, what was closed may overlap: to push it out takes energy
    if (discretization_.input().large_motion)
      p.target[a] =
          std::min(p.target[a], p.target[a] > 0. && U < 0. ? -0.1 * U : -U);
    const double e = p.kind[a] == PointKind::free
                         ? p.interactions[p.interaction[a]].restitution
                         : 0.;
    if (e > 0. && U < 0. && u + h * U <= 0.)
      p.target[a] = std::max(p.target[a], -e * U);
    std::fill_n(&p.sliding_offset[a * dim], dim, 0.);
    // half of the first drag is work with the velocity before
    const bool drags = chains_.beta[a] > 0. && !(p.from_closed && U < 0.);
    if (!p.viscosity.empty())
      p.viscosity[a] = drags ? all_.viscosity[chains_.point[a]] : 0.;
  }

  /** False if there is something to solve in the step of @p node. */
  template <int dim>
  bool LeapfrogPoints<dim>::solve_loose(Node &node)
  {
    const auto &elastic = node.elastic[chain_];
    if (node.settled < 2 || elastic.is_new || !elastic.exists ||
        !elastic.node.is_loose())
      return false;
    const LooseNode<dim> &loose = elastic.node.loose();
    if (!loose.solve(chains_.problem, chains_.frame, chains_.released,
                     elastic.node.merged(), node.problem, chains_.impulse,
                     chains_.velocity))
      return false;
    for (const auto &point : loose.broken()) {
      parted_.push_back(point.index);
      if (node.settled < 3)
        std::fill_n(&chains_.impulse[point.index * dim], dim, 0.);
    }
    // rounds of one step may come here before what holds has been accepted at
    // rest, and nothing looks at it from now on
    for (const auto &x : node.problem.points)
      if (node.settled < 3 && chains_.problem.kind[x.point] == PointKind::rigid)
        for (auto *velocity : {&chains_.velocity, &chains_.old_velocity})
          std::fill_n(&(*velocity)[x.point * dim], dim, 0.);
    node.settled = 3;
    return true;
  }

  /** False if something else than springs is in the step of @p node. */
  template <int dim>
  bool LeapfrogPoints<dim>::solve_elastic(Node &node)
  {
    const unsigned int settled = std::min(node.settled + 1u, 2u);
    node.settled = 0;
    if (!may_be_elastic(chains_, node.problem))
      return false;
    auto &elastic = node.elastic[chain_];
    if (elastic.is_new) {
      elastic.is_new = false;
      elastic.exists =
          elastic.node.reinit(chains_.problem, node.problem, chains_.beta);
    }
    if (!elastic.exists ||
        !elastic.node.solve(chains_.problem, chains_.frame, chains_.closed,
                            node.problem, chains_.impulse, chains_.velocity))
      return false;
    bool closed = false;
    for (std::size_t k = 0; k < node.problem.points.size(); ++k) {
      springs_.push_back(&elastic.node.point(k));
      closed = closed || springs_.back()->closed;
    }
    node.settled = closed ? std::uint8_t(0) : std::uint8_t(settled);
    return true;
  }

  /** The points of @p node are in the step that comes. */
  template <int dim>
  void LeapfrogPoints<dim>::begin(const Node &node)
  {
    for (const auto &x : node.problem.points) {
      set_point(unsigned(x.point));
      moved_.push_back(unsigned(x.point));
    }
    counts_.resize(moved_.size(), mesh_.counts(node.node));
  }

  template <int dim>
  void LeapfrogPoints<dim>::solve_node(Node &node, const double tolerance,
                                       CornerGroups<dim> &groups,
                                       Outcome &outcome)
  {
    const std::size_t first = moved_.size();
    fetch_velocities(node.groups, groups, node.problem);
    const auto take_velocities = [&] {
      for (std::size_t k = 0; k < node.groups.size(); ++k)
        std::copy_n(node.problem.velocity[k].begin(), dim,
                    &groups.velocity[node.groups[k] * dim]);
    };
    bool is_linear = solve_loose(node);
    if (!is_linear) {
      begin(node);
      is_linear = solve_elastic(node);
    }
    if (is_linear) {
      outcome.problems += mesh_.counts(node.node);
      take_velocities();
      return;
    }
    springs_.resize(moved_.size(), nullptr);
    free_ = node.problem.velocity;
    std::optional<HeldNodes<dim>> held;
    NodeReport report;
    const auto solve = [&] {
      node.problem.velocity = free_;
      report = solver_.solve(chains_.problem, chains_.frame, node.problem,
                             chains_.impulse, chains_.solution);
      if (mesh_.counts(node.node)) {
        outcome.sweeps += report.sweeps;
        outcome.newton += report.newton;
        ++outcome.problems;
      }
      return report.converged || report.residual <= tolerance;
    };
    bool solved;
    do {
      solved = solve();
      if (!solved && !held) {
        held.emplace(chains_.problem);
        held->hold(node.problem);
        solved = held->any() && solve();
      }
      take_velocities();
      set_velocities(moved_, first, mesh_, groups, chains_);
    } while (turn_friction(moved_, first, !solved, chains_));
    outcome.converged = outcome.converged && solved;
    if (mesh_.counts(node.node))
      outcome.inexact += !report.converged;
    if (!(report.residual <= outcome.residual)) {
      outcome.residual = report.residual;
      outcome.worst = chains_.point[moved_[first]];
    }
    if (held && held->any()) {
      outcome.held += mesh_.counts(node.node);
      take_held<dim>(*held, chains_, outcome);
    }
  }

  template <int dim>
  auto LeapfrogPoints<dim>::solve(const double h, const double last,
                                  const std::vector<std::uint8_t> &prescribed,
                                  const double tolerance,
                                  CornerGroups<dim> &groups,
                                  const std::vector<std::size_t> &apart)
      -> Outcome
  {
    Outcome outcome;
    OneStepProblem<dim> &p = chains_.problem;
    // the first kick, of half a step, takes half of its impulse from a body at
    // rest as work: it is twice that of the way from closed faces
    p.from_closed = last == 0.;
    p.time_step = h + (last > 0. ? last : h);
    p.theta = h / p.time_step;
    const std::array<double, 2> step = {p.time_step, p.theta};
    const bool is_new = step != steps_[chain_];
    steps_[chain_] = step;
    moved_.clear();
    counts_.clear();
    springs_.clear();
    parted_.clear();
    for (auto at = nodes_.begin(); at != nodes_.end(); ++at) {
      // what nodes have lies in many places: waiting for it is most of the time
      if (nodes_.end() - at > ahead)
        at[ahead].prefetch(chain_);
      Node &node = *at;
      node.elastic[chain_].is_new |= is_new;
      node.is_new |= is_new && !groups.drag.empty();
      if (node.is_new)
        nodes_.collect(node, prescribed, groups, chains_);
      if (!node.problem.points.empty() && !node.is_rigid &&
          !std::binary_search(apart.begin(), apart.end(), node.node))
        solve_node(node, tolerance, groups, outcome);
    }
    return outcome;
  }

  template <int dim>
  void LeapfrogPoints<dim>::solve_rigid(const double tolerance,
                                        const Communicator &communicator,
                                        RigidGroups<dim> &rigid,
                                        CornerGroups<dim> &groups,
                                        Outcome &outcome)
  {
    using Coupled = CoupledNodes<dim>;
    std::vector<typename Coupled::Node> nodes;
    const std::size_t first = moved_.size();
    bool stiff = false;
    for (Node &node : nodes_)
      if (!node.is_rigid || node.problem.points.empty())
        continue;
      else if (rigid.n_free() == 0)
        solve_node(node, tolerance, groups, outcome);
      else {
        begin(node);
        fetch_velocities(node.groups, groups, node.problem);
        nodes.push_back({&node.problem, &node.groups, mesh_.counts(node.node)});
        outcome.problems += nodes.back().counts;
        for (const auto &x : node.problem.points)
          stiff |= chains_.problem.majorant_normal[x.point] == 0.;
      }
    if (!communicator.any(!nodes.empty()))
      return;
    springs_.resize(moved_.size(), nullptr);
    std::vector<const NodeProblem<dim> *> problems;
    unsigned int n_counted = 0;
    for (const auto &node : nodes) {
      problems.push_back(node.problem);
      n_counted += node.counts;
    }
    Coupled coupled(communicator, rigid, solver_, chains_, groups,
                    std::move(nodes));
    std::optional<HeldNodes<dim>> held;
    typename Coupled::Report report;
    const auto solve = [&] {
      report = coupled.solve();
      outcome.sweeps += report.sweeps;
      outcome.newton += report.newton;
      return (report.converged && report.inexact == 0) ||
             report.residual <= tolerance;
    };
    bool solved;
    do {
      solved = solve();
      if (!held && communicator.any(!solved)) {
        held.emplace(chains_.problem);
        for (const auto *problem : problems)
          held->hold(*problem);
        if (communicator.any(held->any()))
          solved = solve();
      }
      set_velocities(moved_, first, mesh_, groups, chains_);
      if (communicator.any(!report.converged || report.inexact > 0) &&
          communicator.any(stiff))
        outcome.impossible =
            "a rigid body that is free has met another one, a support or an "
            "obstacle: in scheme = explicit its points need cells that deform "
            "on the other side; write scheme = moreau-jean";
    } while (!outcome.impossible &&
             communicator.any(turn_friction(
                 moved_, first, communicator.any(!solved), chains_)));
    outcome.converged = outcome.converged && solved;
    outcome.inexact += report.inexact;
    if (!(report.residual <= outcome.residual)) {
      outcome.residual = report.residual;
      if (first < moved_.size()) // else it is on other ranks
        outcome.worst = chains_.point[report.worst];
    }
    if (held && communicator.any(held->any())) {
      outcome.held += n_counted;
      take_held<dim>(*held, chains_, outcome);
    }
  }

  template <int dim>
  void LeapfrogPoints<dim>::add_impulses(const std::vector<int> &row_of_group,
                                         std::vector<double> &rows) const
  {
    for (const Node &node : nodes_) {
      if (!node.is_driven)
        continue;
      for (const auto &point : node.problem.points)
        for (unsigned int side = 0; side < 2; ++side) {
          const auto &sides = point.groups;
          const std::size_t a = point.point;
          if (sides[side] < 0)
            continue;
          const int row = row_of_group[node.groups[std::size_t(sides[side])]];
          if (row < 0)
            continue;
          for (unsigned int r = 0; r < dim; ++r)
            for (unsigned int c = 0; c < dim; ++c)
              rows[std::size_t(row) * dim + c] +=
                  (side == 0 ? -1. : 1.) * chains_.impulse[a * dim + r] *
                  chains_.frame[(a * dim + r) * dim + c];
        }
    }
  }

  template <int dim>
  double
  LeapfrogPoints<dim>::initial_energy(const Communicator &communicator) const
  {
    std::vector<double> terms(chains_.size());
    for (std::size_t a = 0; a < chains_.size(); ++a)
      if (mesh_.counts(mesh_.node_of_point(chains_.point[a])))
        terms[a] = 2. * chains_.problem.weight[a] *
                   stored_energy<dim>(chains_.problem, a);
    return communicator.sum(terms);
  }

  template <int dim>
  void LeapfrogPoints<dim>::serialize(Archive &archive)
  {
    const auto &input = discretization_.input();
    chains_.serialize(
        archive, discretization_.points().n_points,
        {input.large_motion, input.mesh_changes() || has_warm_laws(input)});
    hold_of_face_ = holds_of_faces(discretization_.points(), chains_);
  }

  template class LeapfrogPoints<2>;
  template class LeapfrogPoints<3>;
} // namespace nsfd
