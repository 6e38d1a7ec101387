#include "leapfrog_contacts.h"

#include "local_product.h"

#include "core/disjoint_sets.h"
#include "nonsmooth/frictional_contact/contact_solver.h"

#include <algorithm>
#include <cmath>
#include <map>

// LeapfrogContacts: which contacts push, and the impulses of those that have no
// points beside them.

namespace nsfd
{
  /** Whether it can part, along its normal; false if nothing can move there. */
  template <int dim>
  bool LeapfrogContacts<dim>::set_yield(const dealii::Tensor<1, dim> &normal,
                                        const CornerGroups<dim> &groups,
                                        Contact &contact) const
  {
    bool moves = false;
    double yields = 0., free = 0.;
    for (const auto &[g, share] : contact.ends) {
      if (rigid_)
        add_share(*rigid_, g, share, contact.bodies);
      for (unsigned int c = 0; c < dim; ++c) {
        const double along = share * normal[c];
        moves = moves || inverse_mass_[g * dim + c] > 0.;
        yields += along * along * inverse_mass_[g * dim + c];
        free += along * along / groups.mass[g];
      }
    }
    for (const auto &body : contact.bodies)
      for (const auto &column : body.columns) {
        double along = 0.;
        for (unsigned int c = 0; c < dim; ++c)
          along += normal[c] * column[c];
        yields += along * along;
        moves = true;
      }
    contact.can_part = yields > 1e-12 * free;
    return moves;
  }

  template <int dim>
  auto LeapfrogContacts<dim>::clusters(const std::vector<std::size_t> &node_of)
      -> std::vector<Cluster>
  {
    // contacts, then nodes, other groups, and rigid bodies
    const std::size_t n = chosen_.size();
    std::map<std::size_t, unsigned int> nodes, bodies;
    std::map<unsigned int, unsigned int> groups;
    const auto n_items = [&] {
      return n + nodes.size() + groups.size() + bodies.size();
    };
    for (const unsigned int k : chosen_)
      for (const auto &end : contacts_[k].ends) {
        const std::size_t node = node_of[end.first];
        const auto next = unsigned(n_items());
        if (node == no_node)
          groups.emplace(end.first, next);
        else
          nodes.emplace(node, next);
      }
    for (const unsigned int k : chosen_)
      for (const auto &body : contacts_[k].bodies)
        bodies.emplace(body.first, unsigned(n_items()));
    // nodes at rigid bodies have no problem of their own
    std::vector<std::pair<std::size_t, std::size_t>> at_bodies;
    std::vector<RigidShare<dim>> shares;
    for (unsigned int g = 0; rigid_ && g < node_of.size(); ++g)
      if (node_of[g] != no_node && rigid_->takes(g)) {
        nodes.emplace(node_of[g], unsigned(n_items()));
        shares.clear();
        add_share(*rigid_, g, 1., shares);
        for (const auto &body : shares) {
          bodies.emplace(body.first, unsigned(n_items()));
          at_bodies.emplace_back(node_of[g], body.first);
        }
      }
    DisjointSets sets(n_items());
    for (const auto &[node, body] : at_bodies)
      sets.join(nodes[node], bodies[body]);
    for (unsigned int i = 0; i < n; ++i)
      for (const auto &body : contacts_[chosen_[i]].bodies)
        sets.join(i, bodies[body.first]);
    for (unsigned int i = 0; i < n; ++i)
      for (const auto &end : contacts_[chosen_[i]].ends) {
        const std::size_t node = node_of[end.first];
        sets.join(i, node == no_node ? groups[end.first] : nodes[node]);
      }
    std::map<unsigned int, std::size_t> place; // of sets with nodes
    std::vector<Cluster> result;
    for (const auto &[node, k] : nodes) {
      const auto [entry, is_new] = place.emplace(sets.first(k), result.size());
      if (is_new)
        result.emplace_back();
      result[entry->second].nodes.push_back(node);
    }
    cluster_of_.assign(n, -1);
    for (std::size_t i = 0; i < n; ++i) {
      const auto found = place.find(sets.first(unsigned(i)));
      if (found == place.end())
        continue;
      const Contact &one = contacts_[chosen_[i]];
      cluster_of_[i] = int(found->second);
      result[found->second].contacts.push_back(
          {one.ends, one.bodies, one.frame, one.row.interaction,
           one.target + one.obstacle[0], one.offset(), one.impulse});
    }
    return result;
  }

  template <int dim>
  void LeapfrogContacts<dim>::take(const std::vector<Cluster> &clusters)
  {
    std::vector<std::size_t> next(clusters.size(), 0);
    for (std::size_t i = 0; i < chosen_.size(); ++i)
      if (cluster_of_[i] >= 0) {
        const auto k = std::size_t(cluster_of_[i]);
        contacts_[chosen_[i]].impulse = clusters[k].contacts[next[k]++].impulse;
      }
  }

  template <int dim>
  double LeapfrogContacts<dim>::solve_others(const double tolerance,
                                             std::vector<double> &of_bodies,
                                             CornerGroups<dim> &groups)
  {
    std::vector<unsigned int> others;
    for (std::size_t i = 0; i < chosen_.size(); ++i)
      if (cluster_of_[i] < 0)
        others.push_back(chosen_[i]);
    const std::size_t n = others.size();
    if (n == 0)
      return 0.;
    // contacts of the groups
    std::map<unsigned int, std::vector<std::pair<unsigned int, double>>> at;
    for (unsigned int i = 0; i < n; ++i)
      for (const auto &[group, share] : contacts_[others[i]].ends)
        at[group].emplace_back(i, share);
    // their velocities along the free unknowns of rigid bodies, local
    std::map<std::size_t,
             std::vector<std::pair<unsigned int, std::vector<Vector>>>>
        at_body;
    for (unsigned int i = 0; i < n; ++i)
      for (const auto &body : contacts_[others[i]].bodies) {
        std::vector<Vector> local;
        for (const auto &column : body.columns)
          local.push_back(contacts_[others[i]].in_frame(column));
        at_body[body.first].emplace_back(i, std::move(local));
      }
    ContactProblem problem;
    problem.dimension = dim;
    problem.row_start = {0};
    double mean = 0.;
    std::map<unsigned int, std::array<double, dim * dim>> blocks;
    for (unsigned int i = 0; i < n; ++i) {
      const Contact &one = contacts_[others[i]];
      blocks.clear();
      for (const auto &[group, share] : one.ends)
        for (const auto &[j, other] : at[group]) {
          auto &block = blocks[j];
          const auto &frame = contacts_[others[j]].frame;
          for (unsigned int r = 0; r < dim; ++r)
            for (unsigned int s = 0; s < dim; ++s)
              for (unsigned int c = 0; c < dim; ++c)
                block[r * dim + s] +=
                    share * other * inverse_mass_[group * dim + c] *
                    one.frame[r * dim + c] * frame[s * dim + c];
        }
      for (const auto &body : one.bodies) {
        const auto &all = at_body[body.first];
        const auto &own =
            std::find_if(all.begin(), all.end(), [i](const auto &entry) {
              return entry.first == i;
            })->second;
        for (const auto &[j, other] : all) {
          auto &block = blocks[j];
          for (std::size_t k = 0; k < own.size(); ++k)
            for (unsigned int r = 0; r < dim; ++r)
              for (unsigned int s = 0; s < dim; ++s)
                block[r * dim + s] += own[k][r] * other[k][s];
        }
      }
      for (unsigned int r = 0; r < dim; ++r) {
        for (const auto &[j, block] : blocks)
          for (unsigned int s = 0; s < dim; ++s) {
            problem.column.push_back(int(j * dim + s));
            problem.value.push_back(block[r * dim + s]);
          }
        problem.row_start.push_back(int(problem.column.size()));
        mean += blocks[i][r * dim + r] / double(n * dim);
      }
      problem.friction.push_back(one.friction);
    }
    for (double &value : problem.value)
      value /= mean;
    std::vector<double> r(n * dim);
    problem.q.resize(n * dim);
    for (unsigned int i = 0; i < n; ++i) {
      const Contact &one = contacts_[others[i]];
      const Vector U = relative_velocity(one, groups.velocity);
      for (unsigned int c = 0; c < dim; ++c) {
        r[i * dim + c] = one.impulse[c] * mean;
        problem.q[i * dim + c] = U[c] - (c == 0       ? one.target
                                         : one.turned ? -one.before[c]
                                                      : 0.);
      }
    }
    SolverControl control;
    // what is left over is energy, which adds up over the steps, and bodies at
    // rest have no other
    control.tolerance = part_of_tolerance * tolerance;
    control.attempts = 1; // what is left is bounded by its own books
    const auto report = solve_contact_problem(
        problem, AssembledMethod<ContactMethod::automatic>(), "automatic",
        control, r);
    inexact_ += !report.converged;
    for (unsigned int i = 0; i < n; ++i) {
      Contact &one = contacts_[others[i]];
      for (unsigned int c = 0; c < dim; ++c)
        one.impulse[c] = r[i * dim + c] / mean;
      add(one, one.impulse, groups.velocity);
      for (const auto &body : one.bodies)
        for (std::size_t k = 0; k < body.columns.size(); ++k)
          of_bodies[body.first + k] +=
              product<dim>(one.in_frame(body.columns[k]), one.impulse);
    }
    return at_body.empty() ? 0. : report.residual;
  }

  /** Where the contact works on the bodies it asks for less; true if so. */
  template <int dim>
  bool LeapfrogContacts<dim>::turn(Contact &contact) const
  {
    Vector sum;
    double size = 0.;
    for (unsigned int c = 0; c < dim; ++c) {
      sum[c] = contact.velocity[c] + contact.before[c];
      size += std::abs(contact.impulse[c]) *
              (std::abs(contact.velocity[c]) + std::abs(contact.before[c]));
    }
    const double rubbing = tangential_dot<dim>(contact.impulse, sum),
                 pushing = contact.impulse[0] * sum[0];
    if (!contact.turned && rubbing > 1e-9 * size)
      return contact.turned = true;
    if (contact.target == contact.least || pushing + rubbing <= 1e-12 * size)
      return false;
    contact.target = contact.least;
    return true;
  }

  template <int dim>
  bool LeapfrogContacts<dim>::improve(const CornerGroups<dim> &groups)
  {
    bool is_new = false;
    for (unsigned int k = 0; k < contacts_.size(); ++k) {
      Contact &contact = contacts_[k];
      contact.velocity = relative_velocity(contact, groups.velocity);
      if (!contact.pushes) {
        const double size =
            std::abs(contact.velocity[0]) + std::abs(contact.target);
        if (contact.velocity[0] - contact.target >= -1e-12 * size)
          continue;
        contact.pushes = is_new = true;
        chosen_.push_back(k);
      } else if (contact.friction > 0.)
        is_new |= turn(contact);
    }
    std::sort(chosen_.begin(), chosen_.end());
    return is_new;
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template auto LeapfrogContacts<dim>::clusters(                               \
      const std::vector<std::size_t> &)                                        \
      ->std::vector<Cluster>;                                                  \
  template void LeapfrogContacts<dim>::take(const std::vector<Cluster> &);     \
  template double LeapfrogContacts<dim>::solve_others(                         \
      double, std::vector<double> &, CornerGroups<dim> &);                     \
  template bool LeapfrogContacts<dim>::set_yield(                              \
      const dealii::Tensor<1, dim> &, const CornerGroups<dim> &, Contact &)    \
      const;                                                                   \
  template bool LeapfrogContacts<dim>::improve(const CornerGroups<dim> &)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
