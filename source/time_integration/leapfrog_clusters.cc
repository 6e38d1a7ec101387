#include "leapfrog_points.h"
#include "point_velocities.h"

#include "joined/held_nodes.h"

#include <algorithm>
#include <optional>
#include <unordered_map>

// LeapfrogPoints where faces turn and surfaces meet others.

namespace nsfd
{
  namespace
  {
    /** Of @p from those of @p places from @p first on, as the first of @p to.
     */
    template <int dim>
    void copy_points(const OneStepProblem<dim> &from,
                     const std::vector<unsigned int> &places,
                     const std::size_t first, OneStepProblem<dim> &to)
    {
      to.interactions = from.interactions;
      to.rule = from.rule;
      to.time_step = from.time_step;
      to.theta = from.theta;
      to.from_closed = from.from_closed;
      to.slip_max.assign(from.slip_max.empty() ? 0 : to.n_points, 0.);
      to.viscosity.assign(from.viscosity.empty() ? 0 : to.n_points, 0.);
      to.friction_factor.assign(from.friction_factor.empty() ? 0 : to.n_points,
                                1.);
      const auto copy = [&](const std::size_t width, const auto &one,
                            auto &two) {
        for (std::size_t k = first; k < places.size() && !one.empty(); ++k)
          std::copy_n(one.begin() + long(places[k] * width), width,
                      two.begin() + long((k - first) * width));
      };
      copy(1, from.kind, to.kind);
      copy(1, from.mask, to.mask);
      copy(1, from.contact, to.contact);
      copy(1, from.interaction, to.interaction);
      for (auto member :
           {&OneStepProblem<dim>::weight, &OneStepProblem<dim>::opening_max,
            &OneStepProblem<dim>::compression_stiffness,
            &OneStepProblem<dim>::target, &OneStepProblem<dim>::slip_max,
            &OneStepProblem<dim>::viscosity,
            &OneStepProblem<dim>::strength_factor,
            &OneStepProblem<dim>::opening_factor,
            &OneStepProblem<dim>::friction_factor,
            &OneStepProblem<dim>::majorant_normal,
            &OneStepProblem<dim>::majorant_tangential})
        copy(1, from.*member, to.*member);
      for (auto member :
           {&OneStepProblem<dim>::given_velocity,
            &OneStepProblem<dim>::jump_old, &OneStepProblem<dim>::jump_free,
            &OneStepProblem<dim>::sliding_offset})
        copy(dim, from.*member, to.*member);
    }
  } // namespace

  template <int dim>
  std::vector<double>
  LeapfrogPoints<dim>::turn(const AxesOf &axes_of,
                            const RigidGroups<dim> *const rigid,
                            const CornerGroups<dim> &groups)
  {
    // by less than this what a point does is the same to four digits
    constexpr double least_angle = 1e-4;
    std::vector<double> more;
    for (Node &node : nodes_)
      for (const unsigned int a : node.points) {
        if (chains_.problem.kind[a] == PointKind::separated)
          continue;
        const auto axes = axes_of(chains_.point[a]);
        double square = 0.;
        for (unsigned int k = 0; k < dim * dim; ++k) {
          const double d = axes[k] - chains_.frame[a * dim * dim + k];
          square += d * d;
        }
        if (square < least_angle * least_angle)
          continue;
        const double stored = chains_.turn(a, axes);
        if (mesh_.counts(node.node))
          more.push_back(stored);
        for (auto &elastic : node.elastic)
          elastic.is_new = true;
      }
    if (rigid)
      for (unsigned int a = 0; a < chains_.size(); ++a)
        for (const unsigned int corner : mesh_.corners(chains_.point[a]))
          if (corner != JoinedMesh<dim>::none &&
              rigid->takes(groups.of(corner)))
            set_old_velocity(a, mesh_, groups, chains_);
    return more;
  }

  template <int dim>
  void LeapfrogPoints<dim>::part(const unsigned int point)
  {
    Node &node = nodes_.of(mesh_.node_of_point(point));
    for (const unsigned int a : node.points)
      if (chains_.point[a] == point) {
        chains_.closed[a] = 0;
        chains_.released[a] = LeapfrogChains<dim>::left;
        for (auto &elastic : node.elastic)
          elastic.is_new = true;
        if (!chains_.is_broken(a))
          continue;
        chains_.problem.kind[a] = chains_.other.kind[a] = PointKind::separated;
        for (unsigned int c = 0; c < dim; ++c)
          chains_.impulse[a * dim + c] = 0.;
      }
    node.is_new = true;
  }

  template <int dim>
  void LeapfrogPoints<dim>::solve_cluster(
      Cluster &cluster, const std::vector<std::uint8_t> &prescribed,
      const double tolerance, RigidGroups<dim> *rigid,
      std::vector<double> &of_bodies, CornerGroups<dim> &groups,
      Outcome &outcome)
  {
    const std::size_t first = moved_.size();
    for (const std::size_t node : cluster.nodes) {
      Node &here = nodes_.of(node);
      begin(here);
      here.settled = 0; // what holds has the round-off of a velocity now
    }
    springs_.resize(moved_.size(), nullptr);
    const std::size_t n = moved_.size() - first;
    // the problem: points, then contacts
    OneStepProblem<dim> problem;
    resize(problem, n + cluster.contacts.size());
    std::vector<double> frames, impulses;
    std::vector<LocalSolution<dim>> solutions(problem.n_points);
    NodeProblem<dim> all;
    std::vector<unsigned int> of_all;
    std::unordered_map<unsigned int, int> known;
    const auto local = [&](const unsigned int group) {
      const auto [entry, is_new] = known.emplace(group, int(of_all.size()));
      if (is_new) {
        of_all.push_back(group);
        auto &inverse = all.inverse_mass.emplace_back();
        for (unsigned int c = 0; c < dim; ++c)
          inverse[c] =
              prescribed[group] & (1u << c) ? 0. : 1. / groups.mass[group];
      }
      return entry->second;
    };
    // unknowns of a body, as groups of mass 1
    struct Unknowns {
      int group;
      std::size_t first, size;
    };
    std::vector<Unknowns> bodies;
    const auto add_bodies = [&](const std::vector<RigidShare<dim>> &shares,
                                PointEnds &to) {
      for (const auto &[first, columns] : shares) {
        auto body = std::find_if(bodies.begin(), bodies.end(),
                                 [first = first](const Unknowns &one) {
                                   return one.first == first;
                                 });
        if (body == bodies.end()) {
          body =
              bodies.insert(body, {int(of_all.size()), first, columns.size()});
          for (std::size_t i = 0; i < columns.size(); i += dim) {
            of_all.push_back(unsigned(-1));
            auto &inverse = all.inverse_mass.emplace_back();
            for (unsigned int c = 0; c < dim; ++c)
              inverse[c] = i + c < columns.size() ? 1. : 0.;
          }
        }
        for (std::size_t i = 0; i < columns.size(); i += dim) {
          auto &matrix = to.matrices[to.n_matrices++];
          to.groups[to.size++] = body->group + int(i / dim);
          for (unsigned int c = 0; c < dim; ++c)
            for (unsigned int d = 0; d < dim && i + d < columns.size(); ++d)
              matrix[c * dim + d] = columns[i + d][c];
        }
      }
    };
    std::size_t k = 0;
    std::vector<PointEnds> of_rigid;
    of_rigid.reserve(n);
    std::vector<RigidShare<dim>> shares;
    for (const std::size_t node : cluster.nodes) {
      const Node &here = nodes_.of(node);
      for (const auto &point : here.problem.points) {
        std::array<int, 2> sides = point.groups;
        shares.clear();
        for (const int s : {0, 1})
          if (int &side = sides[std::size_t(s)]; side >= 0) {
            const unsigned int group = here.groups[std::size_t(side)];
            if (rigid)
              add_share(*rigid, group, 2. * s - 1., shares);
            side = local(group);
          }
        all.points.push_back({k, sides});
        if (!shares.empty()) {
          PointEnds &ends = of_rigid.emplace_back();
          for (const int s : {0, 1})
            if (sides[std::size_t(s)] >= 0) {
              ends.groups[ends.size] = sides[std::size_t(s)];
              ends.shares[ends.size++] = 2. * s - 1.;
            }
          add_bodies(shares, ends);
          all.points.back().ends = &ends;
        }
        const double *frame = &chains_.frame[point.point * dim * dim];
        frames.insert(frames.end(), frame, frame + dim * dim);
        ++k;
      }
    }
    std::vector<PointEnds> ends(cluster.contacts.size());
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const auto &contact = cluster.contacts[i];
      for (const auto &[group, share] : contact.ends) {
        ends[i].groups[ends[i].size] = local(group);
        ends[i].shares[ends[i].size++] = share;
      }
      add_bodies(contact.bodies, ends[i]);
      all.points.push_back({n + i, {{-1, -1}}, &ends[i]});
      frames.insert(frames.end(), contact.frame.begin(), contact.frame.end());
    }
    const auto fetch = [&] {
      copy_points(chains_.problem, moved_, first, problem);
      impulses.assign(problem.n_points * dim, 0.);
      for (std::size_t i = 0; i < n; ++i)
        std::copy_n(&chains_.impulse[moved_[first + i] * dim], dim,
                    &impulses[i * dim]);
      for (std::size_t i = 0; i < ends.size(); ++i) {
        const auto &contact = cluster.contacts[i];
        problem.contact[n + i] = 1;
        problem.interaction[n + i] = contact.interaction;
        problem.target[n + i] = contact.target;
        std::copy_n(contact.offset.begin(), dim,
                    &problem.sliding_offset[(n + i) * dim]);
        std::copy_n(contact.impulse.begin(), dim, &impulses[(n + i) * dim]);
      }
    };
    std::vector<std::array<double, dim>> free;
    for (const unsigned int group : of_all) {
      free.emplace_back();
      if (group != unsigned(-1))
        std::copy_n(&groups.velocity[group * dim], dim, free.back().begin());
    }
    std::optional<HeldNodes<dim>> held;
    NodeReport report;
    const auto solve = [&] {
      held.reset();
      fetch();
      const auto attempt = [&] {
        all.velocity = free;
        // what crushes has hundreds of contacts, and takes a hundred times as
        // long for digits that no step asks for
        report =
            solver_.solve(problem, frames, all, impulses, solutions, tolerance);
        outcome.sweeps += report.sweeps;
        outcome.newton += report.newton;
        ++outcome.problems;
        return report.converged || report.residual <= tolerance;
      };
      bool solved = attempt();
      if (!solved) {
        held.emplace(problem);
        held->hold(all);
        solved = held->any() && attempt();
      }
      for (std::size_t i = 0; i < n; ++i) {
        const unsigned int a = moved_[first + i];
        std::copy_n(&impulses[i * dim], dim, &chains_.impulse[a * dim]);
        chains_.solution[a] = solutions[i];
      }
      for (std::size_t g = 0; g < of_all.size(); ++g)
        if (of_all[g] != unsigned(-1))
          std::copy_n(all.velocity[g].begin(), dim,
                      &groups.velocity[of_all[g] * dim]);
      for (const Unknowns &body : bodies)
        for (std::size_t i = 0; i < body.size; ++i)
          of_bodies[body.first + i] =
              all.velocity[std::size_t(body.group) + i / dim][i % dim];
      if (!bodies.empty())
        rigid->move(of_bodies, groups);
      set_velocities(moved_, first, mesh_, groups, chains_);
      return solved;
    };
    bool solved;
    do
      solved = solve();
    while (turn_friction(moved_, first, !solved, chains_));
    for (std::size_t i = 0; i < ends.size(); ++i)
      std::copy_n(&impulses[(n + i) * dim], dim,
                  cluster.contacts[i].impulse.begin());
    outcome.converged = outcome.converged && solved;
    outcome.inexact += !report.converged;
    if (!(report.residual <= outcome.residual)) {
      outcome.residual = report.residual;
      if (n > 0) // else all points of its nodes are between prescribed groups
        outcome.worst = chains_.point[moved_[first]];
    }
    if (held && held->any()) {
      ++outcome.held;
      held->mark(solutions);
      outcome.excess = std::max(outcome.excess, held->excess(impulses));
      for (std::size_t i = 0; i < n; ++i)
        chains_.solution[moved_[first + i]] = solutions[i];
    }
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template std::vector<double> LeapfrogPoints<dim>::turn(                      \
      const AxesOf &, const RigidGroups<dim> *, const CornerGroups<dim> &);    \
  template void LeapfrogPoints<dim>::part(unsigned int);                       \
  template void LeapfrogPoints<dim>::solve_cluster(                            \
      Cluster &, const std::vector<std::uint8_t> &, double,                    \
      RigidGroups<dim> *, std::vector<double> &, CornerGroups<dim> &,          \
      Outcome &)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
