#include "leapfrog_contacts.h"

#include "local_product.h"
#include "obstacle_motion.h"

#include "contact_detection/facet_geometry.h"
#include "contact_detection/touching_rules.h"
#include "core/disjoint_sets.h"
#include "discretization/cell_geometry.h"
#include "discretization/face_sizes.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /**
     * Where the two bodies meet with @p ends as they are: what slides along a
     * facet that turns has a gap that changes with the place.
     */
    template <int dim>
    void meet(const RowEnds<dim> &ends, MovingRow<dim> &row)
    {
      using Partner = typename MovingRow<dim>::Partner;
      if (row.partner == Partner::edge) {
        const Tensor<1, dim> a = ends.of_2[1] - ends.of_2[0],
                             b = ends.of_1[1] - ends.of_1[0],
                             apart = ends.of_1[0] - ends.of_2[0];
        const double aa = a * a, ab = a * b, bb = b * b,
                     det = aa * bb - ab * ab;
        if (!(det > 1e-6 * aa * bb))
          return;
        const double on_2 = (bb * (a * apart) - ab * (b * apart)) / det,
                     on_1 = (ab * (a * apart) - aa * (b * apart)) / det;
        if (on_2 < 0. || on_2 > 1. || on_1 < 0. || on_1 > 1.)
          return;
        row.edge_weights = {{1. - on_2, on_2}};
        row.weights[0] = 1. - on_1;
        row.weights[1] = on_1;
      } else if (row.partner == Partner::facet) {
        typename Surfaces<dim>::Facet facet;
        facet.n_vertices = row.n_facet;
        std::array<double, 4 * dim> x{};
        for (unsigned int v = 0; v < row.n_facet; ++v) {
          facet.vertex[v] = v;
          for (unsigned int c = 0; c < dim; ++c)
            x[v * dim + c] = ends.of_1[v][c];
        }
        std::array<double, dim> y;
        for (unsigned int c = 0; c < dim; ++c)
          y[c] = ends.of_2[0][c];
        const auto plane = plane_of<dim>(facet, x.data());
        row.weights =
            (is_ball(row) ? closest_place<dim>(facet, plane, x.data(), y)
                          : extended_place<dim>(facet, plane, x.data(), y))
                .weights;
      }
    }

    /** What hangs together by the nodes of @p groups. */
    template <int dim>
    typename ActiveSurfaces<dim>::Wholes
    wholes_of(const CornerGroups<dim> &groups, const BodyLayout<dim> &layout,
              const SurfaceContacts<dim> &surfaces, const BodyTable &table)
    {
      const std::size_t n_cells = table.body_of_cell.size(),
                        n = layout.nodes_per_cell();
      typename ActiveSurfaces<dim>::Wholes wholes;
      wholes.node.resize(n_cells * n);
      std::vector<unsigned int> first(groups.size(), unsigned(-1));
      DisjointSets sets(n_cells);
      for (unsigned int node = 0; node < n_cells * n; ++node) {
        // cells of a rigid body have groups of their own
        unsigned int &of_group =
            first[groups.of(layout.own_node(surfaces.first_of_rigid(node)))];
        if (of_group == unsigned(-1))
          of_group = node;
        else
          sets.join(unsigned(node / n), unsigned(of_group / n));
        wholes.node[node] = of_group;
      }
      wholes.of_cell.resize(n_cells);
      for (unsigned int c = 0; c < n_cells; ++c)
        wholes.of_cell[c] = sets.first(c);
      return wholes;
    }
  } // namespace

  template <int dim>
  LeapfrogContacts<dim>::LeapfrogContacts(
      const SceneInput &input, const Discretization<dim> &discretization,
      const OneStepProblem<dim> &all, const Communicator &communicator)
      : input_(input), discretization_(discretization), all_(all),
        layout_(input, discretization), balls_(layout_, discretization.cells()),
        surfaces_(input, discretization, layout_, communicator),
        face_size_(face_sizes(discretization.points()))
  {
    DisjointSets parts(discretization.bodies().size());
    for (const auto &face : discretization.points().faces)
      if (face.bodies[0] >= 0 && face.bodies[1] >= 0)
        parts.join(unsigned(face.bodies[0]), unsigned(face.bodies[1]));
    part_of_.resize(layout_.size());
    for (std::size_t b = 0; b < layout_.size(); ++b)
      part_of_[layout_[b].number] = parts.first(layout_[b].cells[0]);
  }

  template <int dim>
  LeapfrogContacts<dim>::~LeapfrogContacts() = default;

  template <int dim>
  void LeapfrogContacts<dim>::start(const State &state,
                                    const CornerGroups<dim> &groups)
  {
    state_ = state;
    for (std::size_t i = 0; i < state_.kind.size(); ++i)
      if (state_.released_overlap[i] == LeapfrogChains<dim>::left)
        state_.kind[i] = PointKind::separated;
    state_.touches.clear();
    if (state_.obstacle_shift.empty())
      state_.obstacle_shift = initial_shifts(input_);
    n_groups_ = groups.size();
    surfaces_.set_wholes(
        wholes_of(groups, layout_, surfaces_, discretization_.body_table()),
        state_);
  }

  template <int dim>
  void LeapfrogContacts<dim>::set_kinds(const LeapfrogChains<dim> &chains,
                                        const double way)
  {
    for (std::size_t a = 0; a < chains.size(); ++a) {
      if (chains.is_left(a))
        continue;
      // one of the two chains of a point may still hold
      const PointKind other = chains.other.kind[a];
      state_.kind[chains.point[a]] = left(chains, a, way).slid ? PointKind::free
                                     : other == PointKind::free
                                         ? chains.problem.kind[a]
                                         : other;
    }
  }

  template <int dim>
  std::vector<unsigned int>
  LeapfrogContacts<dim>::part(const LeapfrogChains<dim> &chains,
                              const double way)
  {
    std::vector<unsigned int> parted;
    std::vector<char> alone(state_.kind.size(), 0);
    for (std::size_t a = 0; a < chains.size(); ++a) {
      const unsigned int i = chains.point[a];
      if (chains.is_left(a)) {
        state_.kind[i] = PointKind::separated;
        if (chains.is_broken(a)) // meanwhile
          parted.push_back(i);
        continue;
      }
      const Left of = left(chains, a, way);
      alone[i] = of.overlaps || (chains.is_broken(a) && of.slid);
    }
    set_kinds(chains, way);
    const auto before = state_.kind;
    surfaces_.part(state_, alone);
    for (std::size_t i = 0; i < before.size(); ++i)
      if (state_.kind[i] == PointKind::separated &&
          before[i] != PointKind::separated)
        parted.push_back(unsigned(i));
    return parted;
  }

  namespace
  {
    /** Both chains of a point softened or broken, and contact holds there. */
    template <int dim>
    bool has_no_spring(const LeapfrogChains<dim> &chains, const std::size_t a)
    {
      const auto softens = [](const PointKind kind) {
        return kind == PointKind::cohesive || kind == PointKind::free;
      };
      const OneStepProblem<dim> &p = chains.problem;
      return !chains.is_left(a) && softens(p.kind[a]) &&
             softens(chains.other.kind[a]) &&
             p.compression_stiffness[a] + chains.other.compression[a] == 0.;
    }
  } // namespace

  template <int dim>
  auto LeapfrogContacts<dim>::left(const LeapfrogChains<dim> &chains,
                                   const std::size_t a, const double way) const
      -> Left
  {
    constexpr double round_off = 1e-12;
    if (!has_no_spring(chains, a))
      return {};
    const double *u = &chains.problem.jump_free[a * dim],
                 size = face_size_[chains.point[a]], least = inset * size;
    double square = 0.;
    for (unsigned int c = 1; c < dim; ++c)
      square += u[c] * u[c];
    // the other half is for the step in which it is seen
    return {square > least * least,
            -u[0] - chains.released[a] > std::max(way / 2., round_off * size)};
  }

  /** Surfaces go to where the groups are. */
  template <int dim>
  void LeapfrogContacts<dim>::follow(const CornerGroups<dim> &groups)
  {
    groups.scatter(groups.displacement, state_.displacement);
    groups.scatter(groups.velocity, state_.velocity);
    if (rigid_)
      rigid_->show(state_);
    if (groups.size() == n_groups_)
      return;
    n_groups_ = groups.size();
    surfaces_.set_wholes(
        wholes_of(groups, layout_, surfaces_, discretization_.body_table()),
        state_);
  }

  // ------------------------------------------------------ contacts of a step

  template <int dim>
  auto LeapfrogContacts<dim>::relative_velocity(
      const Contact &contact, const std::vector<double> &velocity) const
      -> Vector
  {
    Vector v{}, U{};
    for (const auto &[group, share] : contact.ends)
      for (unsigned int c = 0; c < dim; ++c)
        v[c] += share * velocity[group * dim + c];
    for (unsigned int r = 0; r < dim; ++r) {
      U[r] = -contact.obstacle[r];
      for (unsigned int c = 0; c < dim; ++c)
        U[r] += contact.frame[r * dim + c] * v[c];
    }
    return U;
  }

  template <int dim>
  void LeapfrogContacts<dim>::add(const Contact &contact, const Vector &impulse,
                                  std::vector<double> &velocity) const
  {
    Vector P{};
    for (unsigned int r = 0; r < dim; ++r)
      for (unsigned int c = 0; c < dim; ++c)
        P[c] += contact.frame[r * dim + c] * impulse[r];
    for (const auto &[group, share] : contact.ends)
      for (unsigned int c = 0; c < dim; ++c)
        velocity[group * dim + c] +=
            share * inverse_mass_[group * dim + c] * P[c];
  }

  /** False if nothing can move there. */
  template <int dim>
  bool LeapfrogContacts<dim>::make(const MovingRow<dim> &row,
                                   const CornerGroups<dim> &groups,
                                   Contact &contact) const
  {
    using Partner = typename MovingRow<dim>::Partner;
    contact.row = row;
    const auto group = [&](const std::size_t node) {
      return groups.of(layout_.own_node(node));
    };
    const auto add_group = [&](const unsigned int g, const double share) {
      for (auto &end : contact.ends)
        if (end.first == g) {
          end.second += share;
          return;
        }
      contact.ends.emplace_back(g, share);
    };
    const auto add_end = [&](const std::size_t node, const double share) {
      add_group(group(node), share);
    };
    // where they are in the middle of the step; balls where they touch at the
    // latest: behind each other's centres they would be pushed on
    const bool of_ball = is_ball(row);
    double ahead = time_step_ / 2.;
    if (of_ball && row.rate < 0.)
      ahead = std::min(ahead, std::max(0., row.gap) / -row.rate);
    RowEnds<dim> ends;
    const auto place_of_corner = [&](const std::size_t corner) {
      const std::size_t g = groups.of(corner);
      Point<dim> x = at_node<dim>(layout_.rest(), corner);
      for (unsigned int c = 0; c < dim; ++c)
        x[c] += groups.displacement[g * dim + c] +
                ahead * groups.velocity[g * dim + c];
      return x;
    };
    const auto place = [&](const std::size_t node) {
      return place_of_corner(layout_.own_node(node));
    };
    const auto centre = [&](const unsigned int ball) {
      Point<dim> x;
      for (const auto &[corner, share] : balls_.centre(ball))
        x += share * Tensor<1, dim>(place_of_corner(corner));
      return x;
    };
    std::vector<unsigned int> of_2;
    if (row.partner == Partner::edge)
      for (unsigned int v = 0; v < 2; ++v) {
        ends.of_2[v] = place(row.edge[v]);
        of_2.push_back(group(row.edge[v]));
      }
    else if (of_ball)
      ends.of_2[0] = centre(row.body_2);
    else {
      ends.of_2[0] = place(row.node);
      of_2.push_back(group(row.node));
      add_end(row.node, 1.);
    }
    if (row.partner == Partner::ball)
      ends.of_1[0] = centre(unsigned(row.body_1));
    for (unsigned int v = 0; v < row.n_facet; ++v) {
      ends.of_1[v] = place(row.facet[v]);
      if (std::find(of_2.begin(), of_2.end(), group(row.facet[v])) !=
          of_2.end())
        return false; // neighbours on one surface
    }
    meet<dim>(ends, contact.row);
    if (row.partner == Partner::edge)
      for (unsigned int v = 0; v < 2; ++v)
        add_end(row.edge[v], contact.row.edge_weights[v]);
    for (unsigned int v = 0; v < row.n_facet; ++v)
      add_end(row.facet[v], -contact.row.weights[v]);
    const auto normal =
        row_normal(input_, contact.row, ends, state_.obstacle_shift);
    const auto axes = local_frame<dim>(normal);
    const auto x = row_place(contact.row, ends, normal);
    // both balls are pushed at one place, whatever is between them
    const auto add_ball = [&](const unsigned int ball, const double sign) {
      for (const auto &[corner, share] : balls_.at(ball, place_of_corner, x))
        add_group(groups.of(corner), sign * share);
    };
    if (of_ball)
      add_ball(row.body_2, 1.);
    if (row.partner == Partner::ball)
      add_ball(unsigned(row.body_1), -1.);
    contact.ends.erase(std::remove_if(contact.ends.begin(), contact.ends.end(),
                                      [](const auto &end) {
                                        return std::abs(end.second) < 1e-12;
                                      }),
                       contact.ends.end());
    for (unsigned int r = 0; r < dim; ++r) {
      contact.place[r] = x[r];
      for (unsigned int c = 0; c < dim; ++c)
        contact.frame[r * dim + c] = axes[r][c];
    }
    return set_yield(normal, groups, contact);
  }

  template <int dim>
  void LeapfrogContacts<dim>::find(const double time, const double h,
                                   const std::vector<std::uint8_t> &prescribed,
                                   const RigidGroups<dim> *rigid,
                                   const CornerGroups<dim> &groups)
  {
    time_step_ = h;
    rigid_ = rigid;
    state_.time = time;
    follow(groups);
    inverse_mass_.resize(groups.size() * dim);
    double speed = 0.;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      double square = 0.;
      for (unsigned int c = 0; c < dim; ++c) {
        inverse_mass_[g * dim + c] =
            prescribed[g] & (1u << c) ? 0. : 1. / groups.mass[g];
        const double v = groups.velocity[g * dim + c];
        square += v * v;
      }
      speed = std::max(speed, square);
    }
    for (const auto &obstacle : input_.obstacles) {
      double square = 0.;
      for (unsigned int c = 0; c < dim; ++c)
        if (const auto &v = obstacle.velocity[c])
          square += std::pow(v->at(Point<dim>(), time + h / 2.), 2);
      speed = std::max(speed, square);
    }
    contacts_.clear();
    chosen_.clear();

    // cells around a node meet the same facet at one place; where corners meet,
    // the facets around a vertex have one end and several normals
    std::map<std::vector<unsigned int>, std::vector<std::size_t>> known;
    for (const auto &row : surfaces_.rows(state_, h, std::sqrt(speed))) {
      Contact contact;
      if (!make(row, groups, contact))
        continue;
      std::vector<unsigned int> key{unsigned(row.partner), row.obstacle};
      for (const auto &end : contact.ends)
        key.push_back(end.first);
      auto &alike = known[std::move(key)];
      const auto entry =
          std::find_if(alike.begin(), alike.end(), [&](const std::size_t k) {
            double along = 0.;
            for (unsigned int c = 0; c < dim; ++c)
              along += contacts_[k].frame[c] * contact.frame[c];
            return along > same_normal;
          });
      std::vector<std::size_t> places = {row.place};
      if (row.twin != row.nowhere)
        places.push_back(row.twin);
      double explained = 0.;
      for (const std::size_t place : places)
        explained = std::max(
            explained,
            std::max(row.overlap, state_.surface_overlap[place]) +
                std::max(row.approach, state_.surface_approach[place]));
      // parts of one body had a node in common until now, as a hinge has, and
      // an obstacle was touched by another corner of it
      const bool is_new_surface =
          row.released || (row.body_1 < 0 && explained == 0.) ||
          (row.body_1 >= 0 && row.node != row.nowhere &&
           (explained == 0. ||
            state_.surface_facet[row.place] == Surfaces<dim>::no_key) &&
           part_of_[row.body_1] == part_of_[row.body_2]);
      if (is_new_surface && state_.last_step > 0. && -row.gap > explained)
        explained = contact.row.overlap = -row.gap;
      if (entry != alike.end()) {
        Contact &same = contacts_[*entry];
        same.row.weight += row.weight;
        same.places.insert(same.places.end(), places.begin(), places.end());
        same.known = std::max(same.known, explained);
        continue;
      }
      // two normals may have no way out of both overlaps: none goes deeper
      const bool has_others = !alike.empty();
      for (const std::size_t k : alike)
        contacts_[k].hold();
      alike.push_back(contacts_.size());
      contact.places = std::move(places);
      contact.known = explained;
      using Partner = typename MovingRow<dim>::Partner;
      if (row.partner == Partner::obstacle)
        for (unsigned int c = 0; c < dim; ++c)
          if (const auto &v = input_.obstacles[row.obstacle].velocity[c]) {
            const double own = v->at(Point<dim>(), time + h / 2.);
            for (unsigned int r = 0; r < dim; ++r)
              contact.obstacle[r] += contact.frame[r * dim + c] * own;
          }
      const auto &law = all_.interactions[row.interaction];
      contact.friction = law.friction;
      contact.before = relative_velocity(contact, groups.velocity);
      const double before = contact.before[0];
      // an overlap that is left goes at a tenth of the speed of what closes
      contact.least = std::min(
          -row.gap / h, row.gap < 0. && before < 0. ? -0.1 * before : -before);
      if (law.restitution > 0. && before < 0. && row.gap + h * before <= 0.)
        contact.least = std::max(contact.least, -law.restitution * before);
      // half of what friction takes if it goes on to slide
      contact.target = std::max(
          contact.least,
          std::min(-row.gap / h, law.friction *
                                         std::sqrt(tangential_dot<dim>(
                                             contact.before, contact.before)) /
                                         2. -
                                     std::max(0., before)));
      for (unsigned int r = 0; r < dim; ++r)
        for (unsigned int c = 0; c < dim; ++c)
          contact.impulse[r] += row.share * contact.frame[r * dim + c] *
                                state_.surface_impulse[row.place * dim + c];
      contact.impulse[0] = std::max(contact.impulse[0], 0.);
      if (has_others)
        contact.hold();
      // no impulse keeps apart what is driven together: the overlap tells
      if (!contact.can_part) {
        contact.impulse = {};
        contact.least = contact.target =
            -std::numeric_limits<double>::infinity();
      }
      if (contact.impulse[0] == 0.)
        contact.impulse = {};
      // what has pushed, and what would close: to find these by solving without
      // them takes a solution more
      contact.pushes = contact.impulse[0] > 0. || before < contact.target;
      if (contact.pushes)
        chosen_.push_back(unsigned(contacts_.size()));
      contacts_.push_back(std::move(contact));
    }
  }

  template class LeapfrogContacts<2>;
  template class LeapfrogContacts<3>;
} // namespace nsfd
