#include "rigid_groups.h"

#include "given_inertia.h"
#include "rigid_algebra.h"

#include "core/gather_sums.h"
#include "discretization/cells.h"
#include "linear_algebra/dense_lu.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

// Which groups the rigid bodies of RigidGroups take along, and how they begin.

namespace nsfd
{
  using rigid::diagonalise;
  using rigid::normalise;
  using rigid::product;
  using rigid::times;

  template <int dim>
  RigidGroups<dim>::RigidGroups(const Discretization<dim> &discretization,
                                const JoinedMesh<dim> &mesh,
                                const Communicator &communicator,
                                const GhostCells *ghosts,
                                std::vector<int> body_of_corner)
      : discretization_(discretization), mesh_(mesh),
        communicator_(communicator), ghosts_(ghosts),
        body_of_corner_(std::move(body_of_corner)),
        large_(discretization.input().large_motion)
  {
    int last = -1;
    for (const int body : body_of_corner_)
      last = std::max(last, body);
    bodies_.resize(std::size_t(communicator.max(last) + 1.));
    set_inertia();
  }

  template <int dim>
  auto RigidGroups<dim>::Body::motions(const dealii::Point<dim> &x) const
      -> std::array<Motion, dim>
  {
    std::array<Motion, dim> R{};
    const auto r = (x - centre) / size;
    for (unsigned int c = 0; c < dim; ++c)
      R[c][c] = 1.;
    if constexpr (dim == 2) {
      R[0][2] = -r[1];
      R[1][2] = r[0];
    } else
      for (unsigned int a = 0; a < 3; ++a) { // e_a x r
        R[(a + 1) % 3][3 + a] = -r[(a + 2) % 3];
        R[(a + 2) % 3][3 + a] = r[(a + 1) % 3];
      }
    return R;
  }

  template <int dim>
  dealii::Point<dim> RigidGroups<dim>::Body::place(const Vec3 &at_rest) const
  {
    const Vec3 x = cells.place(at_rest);
    dealii::Point<dim> result;
    for (unsigned int c = 0; c < dim; ++c)
      result[c] = x[c];
    return result;
  }

  /** Centre, length and inertia of the rigid cells. */
  template <int dim>
  void RigidGroups<dim>::set_inertia()
  {
    const Cells<dim> &cells = discretization_.cells();
    const auto for_all_pairs = [&](const auto &act) {
      for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
        const int body = body_of_corner_[cells.first_node[b]];
        if (body < 0 || (ghosts_ && ghosts_->is_ghost(b)))
          continue;
        const auto shape = cells.shape(b);
        const Block &mass = cells.body_class(b).mass;
        for (unsigned int i = 0; i < shape->n_nodes; ++i)
          for (unsigned int j = 0; j < shape->n_nodes; ++j)
            act(std::size_t(body), mass(i * dim, j * dim),
                cells.place(b, shape->nodes[i]),
                cells.place(b, shape->nodes[j]));
      }
    };
    using Place = dealii::Point<dim>;
    constexpr unsigned int n = n_motions;
    std::vector<OrderFreeSum> own(bodies_.size() * n);
    for_all_pairs([&](const std::size_t body, const double m, const Place &x,
                      const Place &) {
      own[body * n].add(m);
      for (unsigned int c = 0; c < dim; ++c)
        own[body * n + 1 + c].add(m * x[c]);
    });
    auto all = sums(own);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      for (unsigned int c = 0; c < dim; ++c)
        bodies_[b].centre[c] = all[b][1 + c] / all[b][0];
    own.assign(bodies_.size() * n, {});
    for_all_pairs([&](const std::size_t body, const double m, const Place &x,
                      const Place &y) {
      const Place &centre = bodies_[body].centre;
      own[body * n].add(m * ((x - centre) * (y - centre)));
    });
    const auto polar = sums(own);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      bodies_[b].size = std::sqrt(polar[b][0] / all[b][0]);
    own.assign(bodies_.size() * n * n, {});
    for_all_pairs([&](const std::size_t body, const double m, const Place &x,
                      const Place &y) {
      const auto R = bodies_[body].motions(x), S = bodies_[body].motions(y);
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          for (unsigned int c = 0; c < dim; ++c)
            own[(body * n + i) * n + j].add(m * R[c][i] * S[c][j]);
    });
    all = sums(own);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      std::copy_n(&all[b * n], n, bodies_[b].rigid_mass.begin());
    const auto given = given_inertia(discretization_, communicator_,
                                     body_of_corner_, bodies_.size());
    for (std::size_t b = 0; b < given.size(); ++b) {
      Body &body = bodies_[b];
      body.is_given = given[b].is_given;
      if (!body.is_given)
        continue;
      const auto &[mass, I] = given[b].inertia;
      for (unsigned int c = 0; c < dim; ++c)
        body.centre[c] = given[b].centre[c];
      // half the trace is polar, in the plane all of it
      body.size = std::sqrt(
          (dim == 2 ? I[2][2] : (I[0][0] + I[1][1] + I[2][2]) / 2.) / mass);
      body.rigid_mass = {};
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          if (i < dim || j < dim)
            body.rigid_mass[i][j] = i == j ? mass : 0.;
          else
            body.rigid_mass[i][j] = (dim == 2 ? I[2][2] : I[i - dim][j - dim]) /
                                    (body.size * body.size);
    }
    for (Body &body : bodies_) {
      body.cells.mass = body.rigid_mass[0][0];
      body.cells.rest = body.cells.centre = in_space<dim>(body.centre);
      for (unsigned int i = dim; i < n; ++i)
        for (unsigned int j = dim; j < n; ++j)
          body.cells.inertia[dim == 2 ? 2 : i - dim][dim == 2 ? 2 : j - dim] =
              body.rigid_mass[i][j] * body.size * body.size;
    }
  }

  template <int dim>
  void RigidGroups<dim>::find_members(const CornerGroups<dim> &groups)
  {
    const Cells<dim> &cells = discretization_.cells();
    members_.clear();
    member_.assign(groups.size(), -1);
    bool meet = false;
    for (std::size_t b = 0; b < cells.bodies.size(); ++b)
      for (std::size_t i = cells.first_node[b]; i < cells.first_node[b + 1];
           ++i) {
        const int body = body_of_corner_[i];
        if (body < 0)
          continue;
        const unsigned int group = groups.of(i);
        if (member_[group] < 0) {
          member_[group] = int(members_.size());
          const auto rest =
              cells.place(b, cells.shape(b)->nodes[i - cells.first_node[b]]);
          members_.push_back({group, unsigned(body), rest,
                              bodies_[std::size_t(body)].motions(rest), 0.,
                              mesh_.counts(mesh_.node(i))});
        } else
          meet |= members_[std::size_t(member_[group])].body != unsigned(body);
      }
    if (communicator_.any(meet))
      throw std::runtime_error(
          "two rigid bodies are joined at a node and not by a face, as if by a "
          "hinge: join them by a face, or part them");
    for (std::size_t i = 0; i < body_of_corner_.size(); ++i)
      if (body_of_corner_[i] < 0 && member_[groups.of(i)] >= 0)
        members_[std::size_t(member_[groups.of(i)])].mass += mesh_.mass(i);
  }

  template <int dim>
  void RigidGroups<dim>::set_masses()
  {
    constexpr unsigned int n = n_motions;
    std::vector<OrderFreeSum> own(bodies_.size() * n * n);
    for (const Member &member : members_)
      for (unsigned int i = 0; i < n && member.counts; ++i)
        for (unsigned int j = 0; j < n; ++j)
          for (unsigned int c = 0; c < dim; ++c)
            own[(member.body * n + i) * n + j].add(
                member.mass * member.R[c][i] * member.R[c][j]);
    const auto all = sums(own);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j < n; ++j)
          bodies_[b].mass[i][j] =
              bodies_[b].rigid_mass[i][j] + all[b * n + i][j];
  }

  /** What supports leave free. */
  template <int dim>
  void RigidGroups<dim>::hold(const PrescribedGroups<dim> &supports)
  {
    constexpr unsigned int n = n_motions;
    const std::size_t n_rows = supports.reactions().size(),
                      n_bodies = bodies_.size();
    std::vector<OrderFreeSum> own(n_bodies * n * (n + n_rows));
    for (const PrescribedRow &row : supports.rigid_rows()) {
      if (!mesh_.counts(mesh_.node_of_point(row.point)))
        continue;
      const Member &member = members_[std::size_t(member_[row.group])];
      const Motion &C = member.R[row.component];
      const std::size_t first = member.body * (n + n_rows),
                        boundary = supports.boundary(row) * dim + row.component;
      for (unsigned int i = 0; i < n; ++i) {
        for (unsigned int j = 0; j < n; ++j)
          own[(first + i) * n + j].add(C[i] * C[j]);
        own[(first + n + boundary) * n + i].add(C[i]);
      }
    }
    for (const Pin &pin : pins_) {
      if (!communicator_.is_root())
        break; // all ranks know all of them
      const Body &body = bodies_[pin.body];
      for (const Motion &C : body.motions(body.place(pin.at)))
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < n; ++j)
            own[(pin.body * (n + n_rows) + i) * n + j].add(C[i] * C[j]);
    }
    const auto all = sums(own);
    for (std::size_t b = 0; b < n_bodies; ++b) {
      Body &body = bodies_[b];
      const auto first = all.begin() + long(b * (n + n_rows));
      Matrix G;
      std::copy_n(first, n, G.begin());
      body.rows.assign(first + n, first + long(n + n_rows));
      const Matrix Q = diagonalise<n>(G);
      double trace = 0.;
      for (unsigned int i = 0; i < n; ++i)
        trace += G[i][i];
      body.is_held = trace > 0.;
      body.free.clear();
      body.inverse_of_rows = {};
      for (unsigned int k = 0; k < n; ++k)
        // squares: rows are independent down to a millionth of the size
        if (G[k][k] > 1e-12 * trace)
          for (unsigned int i = 0; i < n; ++i)
            for (unsigned int j = 0; j < n; ++j)
              body.inverse_of_rows[i][j] += Q[i][k] * Q[j][k] / G[k][k];
        else {
          Motion &column = body.free.emplace_back();
          for (unsigned int i = 0; i < n; ++i)
            column[i] = Q[i][k];
        }
      normalise<n>(body.mass, body.free);
      body.first_free = b == 0 ? 0 : n_free_;
      n_free_ = body.first_free + body.free.size();
    }
  }

  template <int dim>
  void RigidGroups<dim>::find(const CornerGroups<dim> &groups,
                              PrescribedGroups<dim> &supports)
  {
    find_members(groups);
    if (large_)
      set_centres(groups);
    std::vector<std::uint8_t> rigid(groups.size(), 0);
    for (const Member &member : members_)
      rigid[member.group] = 1;
    supports.find(groups, rigid);
    set_masses();
    hold(supports);
  }

  template <int dim>
  void RigidGroups<dim>::check(const double end,
                               const CornerGroups<dim> &groups,
                               const PrescribedGroups<dim> &supports) const
  {
    // what turns is where it is at the start only: in a time in which nothing
    // turns by more than an angle p the chord of a turn leaves the velocity by
    // p/2 of it, the round-off of places, epsilon of a radius, is epsilon/p
    constexpr double angle = 1e-7;
    double h = (large_ ? 1e-9 : 1e-3) * end;
    for (unsigned int k = 0; large_ && k < 4; ++k) {
      const auto all = asked(0., h, supports, groups);
      double turn = 0.;
      for (std::size_t b = 0; b < bodies_.size(); ++b) {
        Body body = bodies_[b];
        body.velocity = times(body.inverse_of_rows, all[b]);
        turn = std::max(turn, h * space::norm(body.spin()));
      }
      if (!(turn > 0.) || (turn > 0.5 * angle && turn < 2. * angle))
        break;
      h = std::min(1e-3 * end, h * angle / turn);
    }
    const double allowed = large_ ? 1e-6 : 1e-9;
    // a pin asks for what is left of its way, the round-off of two places
    double places = 0.;
    for (const Pin &pin : pins_)
      for (unsigned int c = 0; c < dim; ++c)
        places = std::max(places, std::abs(pin.at[c]));
    const double round_off =
        8. * std::numeric_limits<double>::epsilon() * places / h;
    const std::vector<double> all_shares = {0., 0.3, 0.7, 1.};
    for (std::size_t k = 0; k < (large_ ? 1 : all_shares.size()); ++k) {
      const double share = all_shares[k];
      const auto all = asked(share * end, h, supports, groups);
      double size = 0., wrong = 0.;
      for (const PrescribedRow &row : supports.rigid_rows()) {
        const Member &member = members_[std::size_t(member_[row.group])];
        const double g = supports.velocity(row, share * end, h, groups);
        const Motion V =
            times(bodies_[member.body].inverse_of_rows, all[member.body]);
        size = std::max(size, std::abs(g));
        wrong =
            std::max(wrong, std::abs(product(member.R[row.component], V) - g));
      }
      if (communicator_.max(wrong) >
          allowed * communicator_.max(size) + round_off)
        throw std::runtime_error(
            "the motion that boundaries ask of a rigid body is not one of a "
            "rigid body: write the same motion wherever it is held");
    }
  }

  template <int dim>
  void RigidGroups<dim>::start(CornerGroups<dim> &groups)
  {
    constexpr unsigned int n = n_motions;
    const Cells<dim> &cells = discretization_.cells();
    const auto place_of = [&](const Body &body, const std::size_t b,
                              const dealii::Point<dim> &node) {
      const auto rest = cells.place(b, node);
      return large_ ? body.place(in_space<dim>(rest)) : rest;
    };
    std::vector<OrderFreeSum> own(bodies_.size() * n);
    // of bodies whose mass is not that of their cells: of the cells
    std::vector<OrderFreeSum> fit(bodies_.size() * n * n);
    const auto add = [&](const std::size_t body, const auto &R, const double m,
                         const double *v) {
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int c = 0; c < dim; ++c)
          own[body * n + i].add(m * R[c][i] * v[c]);
    };
    const auto add_mass = [&](const std::size_t body, const auto &R,
                              const auto &S, const double m) {
      for (unsigned int i = 0; i < n && bodies_[body].is_given; ++i)
        for (unsigned int j = 0; j < n; ++j)
          for (unsigned int c = 0; c < dim; ++c)
            fit[(body * n + i) * n + j].add(m * R[c][i] * S[c][j]);
    };
    for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
      const std::size_t first = cells.first_node[b];
      if (body_of_corner_[first] < 0 || (ghosts_ && ghosts_->is_ghost(b)))
        continue;
      const auto body = std::size_t(body_of_corner_[first]);
      const auto shape = cells.shape(b);
      const Block &mass = cells.body_class(b).mass;
      for (unsigned int i = 0; i < shape->n_nodes; ++i) {
        const auto R =
            bodies_[body].motions(place_of(bodies_[body], b, shape->nodes[i]));
        for (unsigned int j = 0; j < shape->n_nodes; ++j) {
          add(body, R, mass(i * dim, j * dim),
              &groups.velocity[groups.of(first + j) * dim]);
          if (bodies_[body].is_given)
            add_mass(body, R,
                     bodies_[body].motions(
                         place_of(bodies_[body], b, shape->nodes[j])),
                     mass(i * dim, j * dim));
        }
      }
    }
    for (const Member &member : members_)
      if (member.counts) {
        add(member.body, member.R, member.mass,
            &groups.velocity[std::size_t(member.group) * dim]);
        add_mass(member.body, member.R, member.R, member.mass);
      }
    const auto momentum = sums(own), of_cells = sums(fit);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      Body &body = bodies_[b];
      DenseLU M;
      M.reinit(n);
      for (unsigned int i = 0; i < n; ++i)
        std::copy_n(
            (body.is_given ? of_cells[b * n + i] : body.mass[i]).begin(), n,
            M.row(int(i)));
      body.velocity = momentum[b];
      M.factorise();
      M.solve(body.velocity.data());
      body.before = body.velocity;
    }
    scatter(groups);
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template RigidGroups<dim>::RigidGroups(                                      \
      const Discretization<dim> &, const JoinedMesh<dim> &,                    \
      const Communicator &, const GhostCells *, std::vector<int>);             \
  template dealii::Point<dim> RigidGroups<dim>::Body::place(const Vec3 &)      \
      const;                                                                   \
  template void RigidGroups<dim>::find(const CornerGroups<dim> &,              \
                                       PrescribedGroups<dim> &);               \
  template void RigidGroups<dim>::check(double, const CornerGroups<dim> &,     \
                                        const PrescribedGroups<dim> &) const;  \
  template void RigidGroups<dim>::start(CornerGroups<dim> &)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
