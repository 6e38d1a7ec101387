#include "swept_surfaces.h"

namespace nsfd
{
  namespace
  {
    /** By when two have met, @p away the vector from the other one's nearest
     * place to the centre, at (part, s). */
    template <typename Away>
    std::optional<double> missed_ball(const std::size_t n_parts,
                                      const RoundContact &contact,
                                      const double radius, const Away &away)
    {
      return missed_round_contact(
          n_parts, contact,
          [&](const std::size_t k, const double s) {
            return norm(away(k, s)) - radius;
          },
          [&](const std::size_t k, const double s) {
            const auto n = away(k, s);
            return sum({}, 1. / norm(n), n);
          });
    }
  } // namespace

  template <int dim>
  void find_missed_balls(const Surfaces<dim> &surfaces,
                         const SweptSurfaces<dim> &swept,
                         const BoxTree<dim> &tree, const PassingBodies &bodies,
                         std::optional<MissedContact<dim>> &first)
  {
    const auto &balls = surfaces.balls;
    std::vector<typename BoxTree<dim>::Entry> entries;
    for (unsigned int b = 0; b < balls.size(); ++b)
      entries.emplace_back(
          swept.swept(&balls[b].vertex, &balls[b].vertex + 1, balls[b].radius),
          b);
    const BoxTree<dim> tree_of_balls(entries);
    const auto take = [&](const RoundContact &contact,
                          const typename Surfaces<dim>::Ball &ball,
                          const unsigned int other, const double time) {
      const auto [k, s] = swept.part_of(time);
      take_first(first, {std::min(1., time + 0.5 * contact.safe / contact.way),
                         other, ball.body, swept.part(k).at(ball.vertex, s)});
    };
    RoundContact contact;
    for (unsigned int b = 0; b < balls.size(); ++b) {
      const auto &ball = balls[b];
      if (!bodies.is_own(ball.body))
        continue;
      tree_of_balls.near(entries[b].first, [&](const auto &entry) {
        const auto &other = balls[entry.second];
        contact.safe = std::min(swept.safe(ball), swept.safe(other));
        contact.unseen = inset * std::min(ball.radius, other.radius);
        contact.way = swept.way(ball.vertex, other.vertex);
        if (entry.second <= b || contact.way <= contact.safe ||
            !bodies.may_touch(ball.body, other.body))
          return;
        const auto time =
            missed_ball(swept.n_parts(), contact, ball.radius + other.radius,
                        [&](const std::size_t k, const double s) {
                          return difference(swept.part(k).at(ball.vertex, s),
                                            swept.part(k).at(other.vertex, s));
                        });
        if (time)
          take(contact, ball, other.body, *time);
      });
      tree.near(entries[b].first, [&](const auto &entry) {
        const unsigned int f = entry.second, other = surfaces.facets[f].body;
        contact.safe = std::min(swept.safe(ball), swept.safe(f));
        contact.unseen =
            inset * std::min(ball.radius, swept.first_plane(f).size);
        contact.way = swept.way_past(ball.vertex, f);
        if (contact.way <= contact.safe || !bodies.may_touch(ball.body, other))
          return;
        const auto away = [&](const std::size_t k, const double s) {
          const FacetOnTheWay<dim> facet = swept.facet(f, k, s);
          const Place<dim> y = swept.part(k).at(ball.vertex, s);
          return difference(
              y, closest_place<dim>(facet.facet, facet.plane, facet.x.data(), y)
                     .place);
        };
        const auto time =
            missed_ball(swept.n_parts(), contact, ball.radius, away);
        if (!time)
          return;
        // only what comes from in front of it
        const auto [k, s] = swept.part_of(*time);
        if (dot(away(k, s), swept.facet(f, k, s).plane.normal) > 0.)
          take(contact, ball, other, *time);
      });
    }
  }

#define INSTANTIATE(dim)                                                       \
  template void find_missed_balls<dim>(                                        \
      const Surfaces<dim> &, const SweptSurfaces<dim> &, const BoxTree<dim> &, \
      const PassingBodies &, std::optional<MissedContact<dim>> &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
