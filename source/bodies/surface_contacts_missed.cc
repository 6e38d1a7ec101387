#include "surface_contacts.h"

#include "contact_detection/straight_ways.h"
#include "contact_detection/touching_rules.h"
#include "core/gather.h"
#include "obstacle_geometry.h"
#include "turning_bodies.h"

#include "nsfd/scene/scene_input.h"

#include <cmath>
#include <set>

// SurfaceContacts: what a step passes over.

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** A node or the centre of a ball that may meet an obstacle in a step. */
    template <int dim>
    struct Traveller {
      Point<dim> from, to;
      double radius = 0.;
      unsigned int body = 0;
    };

    /** By when it has met the obstacle, in parts of the step. */
    template <int dim>
    std::optional<MissedContact<dim>> missed_obstacle(
        const ObstacleInput &obstacle, const std::array<Tensor<1, 3>, 2> &shift,
        const Traveller<dim> &traveller, const TurningBodies<dim> &turning)
    {
      const std::size_t n = turning.n_parts();
      const auto share = [&](const std::size_t k, const double s) {
        return (double(k) + s) / double(n);
      };
      const auto place_at = [&](const std::size_t k, const double s) {
        const auto end = [&](const std::size_t part) {
          return turning.place(traveller.body, traveller.from, traveller.to,
                               double(part) / double(n));
        };
        const Point<dim> a = end(k), b = end(k + 1);
        return Point<dim>(a + s * (b - a));
      };
      const auto geometry = [&](const double time) {
        const Tensor<1, 3> moved = shift[0] + time * (shift[1] - shift[0]);
        const std::array<double, 3> values = {{moved[0], moved[1], moved[2]}};
        return ObstacleGeometry<dim>(obstacle, values.data());
      };
      RoundContact contact;
      const double thickness = obstacle.shape->thickness(obstacle);
      contact.safe = 0.5 * deepest * thickness; // as in SweptSurfaces
      contact.unseen = 0.5 * inset * thickness;
      for (std::size_t k = 0; k < n; ++k) {
        Tensor<1, dim> way = place_at(k, 1.) - place_at(k, 0.);
        for (unsigned int d = 0; d < dim; ++d)
          way[d] -= (shift[1][d] - shift[0][d]) / double(n);
        contact.way += way.norm();
      }
      if (contact.way <= contact.safe)
        return std::nullopt;
      const auto time = missed_round_contact(
          n, contact,
          [&](const std::size_t k, const double s) {
            return geometry(share(k, s)).gap(place_at(k, s)) - traveller.radius;
          },
          [&](const std::size_t k, const double s) {
            std::array<double, dim> result;
            const auto normal = geometry(share(k, s)).normal(place_at(k, s));
            for (unsigned int d = 0; d < dim; ++d)
              result[d] = normal[d];
            return result;
          });
      if (!time)
        return std::nullopt;
      MissedContact<dim> missed;
      missed.share = std::min(1., *time + 0.5 * contact.safe / contact.way);
      missed.body_2 = traveller.body;
      const std::size_t k = std::min(std::size_t(*time * double(n)), n - 1);
      const Point<dim> there = place_at(k, *time * double(n) - double(k));
      for (unsigned int d = 0; d < dim; ++d)
        missed.place[d] = there[d];
      return missed;
    }
  } // namespace

  template <int dim>
  void SurfaceContacts<dim>::look_at_obstacles(
      const State &old, const State &next, const TurningBodies<dim> &turning,
      std::optional<MissedContact<dim>> &first) const
  {
    std::set<std::pair<std::size_t, unsigned int>> known;
    for (const auto &[c, f, o] : active_.obstacle_faces()) {
      const ObstacleInput &obstacle = input_.obstacles[o];
      Traveller<dim> traveller;
      traveller.body = table_.body_of_cell[c];
      if (!bodies_.is_own(traveller.body) ||
          !std::isfinite(obstacle.shape->thickness(obstacle)))
        continue;
      std::array<Tensor<1, 3>, 2> shift;
      for (unsigned int d = 0; d < 3; ++d) {
        if (!old.obstacle_shift.empty())
          shift[0][d] = old.obstacle_shift[3 * o + d];
        if (!next.obstacle_shift.empty())
          shift[1][d] = next.obstacle_shift[3 * o + d];
      }
      const auto look = [&](const std::size_t key) {
        if (!known.emplace(key, o).second)
          return;
        if (const auto missed =
                missed_obstacle(obstacle, shift, traveller, turning)) {
          MissedContact<dim> of(*missed);
          of.body_1 = MissedContact<dim>::first_obstacle + o;
          take_first(first, of);
        }
      };
      traveller.radius = cells_.ball_radius(traveller.body);
      if (traveller.radius > 0.) {
        const auto r = std::size_t(table_.bodies[traveller.body].rigid);
        for (unsigned int d = 0; d < dim; ++d) {
          traveller.from[d] = old.rigid[13 * r + d];
          traveller.to[d] = next.rigid[13 * r + d];
        }
        look(cells_.n_nodes() + traveller.body);
        continue;
      }
      for (const unsigned int node : cells_.faces(c)[f].nodes) {
        const std::size_t global = cells_.first_node(c) + node;
        if (!active_.is_corner(c, f, node))
          continue;
        traveller.from = bodies_.place(old, bodies_.own_node(global));
        traveller.to = bodies_.place(next, bodies_.own_node(global));
        look(active_.merged(global));
      }
    }
  }

  template <int dim>
  std::optional<MissedContact<dim>>
  SurfaceContacts<dim>::missed(const State &old, const State &next) const
  {
    const TurningBodies<dim> turning(
        table_, old.rigid, next.rigid,
        [this](const unsigned int b) { return cells_.ball_radius(b) > 0.; });
    std::optional<MissedContact<dim>> first;
    look_at_obstacles(old, next, turning, first);
    if (!input_.contacts.empty()) {
      const std::vector<double> end = active_.motion().places_in(next);
      std::vector<std::vector<double>> between;
      StepPath path = {active_.motion().positions()};
      for (std::size_t k = 1; k < turning.n_parts(); ++k) {
        std::vector<double> &x = between.emplace_back(end);
        for (std::size_t node = 0; node < cells_.n_nodes(); ++node) {
          const unsigned int body =
              table_.body_of_cell[node / cells_.nodes_per_cell()];
          Vector from, to;
          for (unsigned int d = 0; d < dim; ++d) {
            from[d] = active_.motion().positions()[node * dim + d];
            to[d] = end[node * dim + d];
          }
          const Vector there = turning.place(
              body, from, to, double(k) / double(turning.n_parts()));
          for (unsigned int d = 0; d < dim; ++d)
            x[node * dim + d] = there[d];
        }
        // centres
        const double share = double(k) / double(turning.n_parts());
        for (std::size_t i = cells_.n_nodes() * dim; i < x.size(); ++i)
          x[i] =
              (1. - share) * active_.motion().positions()[i] + share * end[i];
      }
      for (const auto &x : between)
        path.push_back(x.data());
      path.push_back(end.data());
      const auto found = first_missed<dim>(
          active_.set().surfaces, path, thickness_,
          [this](const unsigned int b) { return bodies_.is_own(b); },
          [this](const unsigned int a, const unsigned int b) {
            return blocks_.of(a, b) < 0 || active_.are_joined(a, b);
          });
      if (found)
        take_first(first, *found);
    }
    std::vector<MissedContact<dim>> own;
    if (first)
      own.push_back(*first);
    for (const auto &other : gather_all(all_, own))
      take_first(first, other);
    return first;
  }

#define INSTANTIATE(dim)                                                       \
  template std::optional<MissedContact<dim>> SurfaceContacts<dim>::missed(     \
      const State &, const State &) const

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
