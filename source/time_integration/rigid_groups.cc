#include "rigid_groups.h"

#include "rigid_algebra.h"

#include "core/gather_sums.h"
#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using rigid::product;
  using rigid::times;

  /** Sums per body, one after the other, of all ranks. */
  template <int dim>
  auto RigidGroups<dim>::sums(const std::vector<OrderFreeSum> &own) const
      -> std::vector<Motion>
  {
    const auto values = gather_sums(communicator_, own);
    std::vector<Motion> result(values.size() / n_motions);
    for (std::size_t k = 0; k < values.size(); ++k)
      result[k / n_motions][k % n_motions] = values[k];
    return result;
  }

  /** C^T g of all bodies. Collective. */
  template <int dim>
  auto RigidGroups<dim>::asked(const double time, const double h,
                               const PrescribedGroups<dim> &supports,
                               const CornerGroups<dim> &groups) const
      -> std::vector<Motion>
  {
    std::vector<OrderFreeSum> own(bodies_.size() * n_motions);
    for (const PrescribedRow &row : supports.rigid_rows()) {
      if (!mesh_.counts(mesh_.node_of_point(row.point)))
        continue;
      const Member &member = members_[std::size_t(member_[row.group])];
      double g = supports.velocity(row, time, h, groups);
      if (large_)
        g -= bodies_[member.body].beside_chord(
            member.rest + at_node<dim>(groups.displacement, member.group),
            h)[row.component];
      for (unsigned int i = 0; i < n_motions; ++i)
        own[member.body * n_motions + i].add(g * member.R[row.component][i]);
    }
    for (const Pin &pin : pins_) {
      if (!communicator_.is_root())
        break; // all ranks know all of them
      const Body &body = bodies_[pin.body];
      const auto x = body.place(pin.at);
      const auto R = body.motions(x);
      const Vec3 turn = body.beside_chord(x, h);
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int i = 0; i < n_motions; ++i)
          own[pin.body * n_motions + i].add(((pin.at[c] - x[c]) / h - turn[c]) *
                                            R[c][i]);
    }
    return sums(own);
  }

  template <int dim>
  void RigidGroups<dim>::scatter(CornerGroups<dim> &groups) const
  {
    for (const Member &member : members_)
      for (unsigned int c = 0; c < dim; ++c)
        groups.velocity[std::size_t(member.group) * dim + c] =
            product(member.R[c], bodies_[member.body].velocity);
  }

  template <int dim>
  void RigidGroups<dim>::set_velocities(const double time, const double h,
                                        const double kick,
                                        const std::vector<double> &forces,
                                        const std::vector<double> &loads,
                                        const PrescribedGroups<dim> &supports,
                                        CornerGroups<dim> &groups)
  {
    constexpr unsigned int n = n_motions;
    std::vector<OrderFreeSum> own(bodies_.size() * n);
    for (const Member &member : members_)
      for (unsigned int c = 0; c < dim && member.counts; ++c) {
        const std::size_t k = std::size_t(member.group) * dim + c;
        const double force = forces[k] + (loads.empty() ? 0. : loads[k]);
        for (unsigned int i = 0; i < n; ++i)
          own[member.body * n + i].add(kick * force * member.R[c][i]);
      }
    const auto given = sums(own), wanted = asked(time, h, supports, groups);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      Body &body = bodies_[b];
      body.before = body.velocity;
      body.cells_before = body.cells;
      body.centre_before = body.centre;
      body.given = given[b];
      Motion push = given[b];
      if (body.is_held) {
        body.velocity = times(body.inverse_of_rows, wanted[b]);
        Motion change;
        for (unsigned int i = 0; i < n; ++i)
          change[i] = body.before[i] - body.velocity[i];
        const Motion kept = times(body.mass, change);
        for (unsigned int i = 0; i < n; ++i)
          push[i] += kept[i];
      }
      for (const Motion &column : body.free) {
        const double y = product(column, push);
        for (unsigned int i = 0; i < n; ++i)
          body.velocity[i] += y * column[i];
      }
      body.without = body.velocity;
    }
    scatter(groups);
  }

  template <int dim>
  std::vector<std::array<double, dim>>
  RigidGroups<dim>::columns(const unsigned int group, std::size_t &first) const
  {
    const Member &member = members_[std::size_t(member_[group])];
    const Body &body = bodies_[member.body];
    first = body.first_free;
    std::vector<std::array<double, dim>> result(body.free.size());
    for (std::size_t k = 0; k < result.size(); ++k)
      for (unsigned int c = 0; c < dim; ++c)
        result[k][c] = product(member.R[c], body.free[k]);
    return result;
  }

  template <int dim>
  void add_share(const RigidGroups<dim> &rigid, const unsigned int group,
                 const double share, std::vector<RigidShare<dim>> &shares)
  {
    if (!rigid.takes(group))
      return;
    std::size_t first = 0;
    const auto of_group = rigid.columns(group, first);
    if (of_group.empty())
      return;
    auto found =
        std::find_if(shares.begin(), shares.end(), [first](const auto &known) {
          return known.first == first;
        });
    if (found == shares.end())
      found = shares.insert(found, {first, std::vector<std::array<double, dim>>(
                                               of_group.size())});
    for (std::size_t k = 0; k < of_group.size(); ++k)
      for (unsigned int c = 0; c < dim; ++c)
        found->columns[k][c] += share * of_group[k][c];
  }

  template <int dim>
  void RigidGroups<dim>::move(const std::vector<double> &y,
                              CornerGroups<dim> &groups)
  {
    for (Body &body : bodies_) {
      body.velocity = body.without;
      for (std::size_t k = 0; k < body.free.size(); ++k)
        for (unsigned int i = 0; i < n_motions; ++i)
          body.velocity[i] += y[body.first_free + k] * body.free[k][i];
    }
    scatter(groups);
  }

  template <int dim>
  auto RigidGroups<dim>::sizes() const -> Sizes
  {
    Sizes sums;
    for (const Body &body : bodies_) {
      Motion change = body.velocity;
      for (unsigned int i = 0; i < n_motions; ++i)
        change[i] -= body.without[i];
      sums.motion += product(body.without, times(body.mass, body.without));
      sums.impulses += product(change, times(body.mass, change));
    }
    return sums;
  }

  template <int dim>
  double RigidGroups<dim>::work(const double kick,
                                PrescribedGroups<dim> &supports) const
  {
    constexpr unsigned int n = n_motions;
    std::vector<OrderFreeSum> own(bodies_.size() * n);
    for (const Member &member : members_) {
      if (!member.counts)
        continue;
      const double *P =
          &supports.rows()[std::size_t(supports.row_of_group()[member.group]) *
                           dim];
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int c = 0; c < dim; ++c)
          own[member.body * n + i].add(P[c] * member.R[c][i]);
    }
    const auto of_points = sums(own);
    double work = 0.;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const Body &body = bodies_[b];
      if (!body.is_held)
        continue;
      Motion change, mean;
      for (unsigned int i = 0; i < n; ++i) {
        change[i] = body.velocity[i] - body.before[i];
        mean[i] = (body.velocity[i] + body.before[i]) / 2.;
      }
      Motion impulse = times(body.mass, change);
      for (unsigned int i = 0; i < n; ++i)
        impulse[i] -= body.given[i] + of_points[b][i];
      work += product(impulse, mean);
      const Motion share = times(body.inverse_of_rows, impulse);
      for (std::size_t k = 0; k < body.rows.size(); ++k)
        supports.reactions()[k] += product(body.rows[k], share) / kick;
    }
    return work;
  }

  template <int dim>
  double RigidGroups<dim>::kinetic_energy(const CornerGroups<dim> &groups,
                                          std::vector<double> &terms) const
  {
    for (const Member &member : members_)
      for (unsigned int c = 0; c < dim; ++c) {
        const std::size_t k = std::size_t(member.group) * dim + c;
        terms[k] = member.mass * groups.velocity[k] * groups.velocity[k] / 2.;
      }
    double energy = 0.;
    for (const Body &body : bodies_)
      energy +=
          product(body.velocity, times(body.rigid_mass, body.velocity)) / 2.;
    return energy;
  }

  template <int dim>
  void RigidGroups<dim>::go_back()
  {
    for (Body &body : bodies_) {
      body.velocity = body.before;
      body.cells = body.cells_before;
      body.centre = body.centre_before;
    }
  }

  template <int dim>
  void RigidGroups<dim>::serialize(Archive &archive)
  {
    std::vector<double> all;
    for (const Body &body : bodies_)
      all.insert(all.end(), body.velocity.begin(), body.velocity.end());
    archive.common("rigid_bodies", all);
    if (archive.reads() && all.size() != bodies_.size() * n_motions)
      throw BadCheckpoint("rigid_bodies has another number of values");
    std::vector<double> centres; // orientations are those of the state
    for (const Body &body : bodies_) {
      centres.insert(centres.end(), body.centre.begin_raw(),
                     body.centre.end_raw());
      centres.insert(centres.end(), body.cells.centre.begin(),
                     body.cells.centre.end());
    }
    if (large_)
      archive.common("rigid_centres", centres);
    if (!archive.reads())
      return;
    if (centres.size() != bodies_.size() * (dim + 3))
      throw BadCheckpoint("rigid_centres has another number of values");
    for (std::size_t b = 0; b < bodies_.size() && large_; ++b) {
      const double *from = &centres[b * (dim + 3)];
      std::copy_n(from, dim, bodies_[b].centre.begin_raw());
      std::copy_n(from + dim, 3, bodies_[b].cells.centre.begin());
    }
    for (std::size_t k = 0; k < all.size(); ++k)
      bodies_[k / n_motions].velocity[k % n_motions] = all[k];
  }

  template void add_share(const RigidGroups<2> &, unsigned int, double,
                          std::vector<RigidShare<2>> &);
  template void add_share(const RigidGroups<3> &, unsigned int, double,
                          std::vector<RigidShare<3>> &);
  template class RigidGroups<2>;
  template class RigidGroups<3>;
} // namespace nsfd
