#include "swept_surfaces.h"

#include <numeric>
#include <utility>

namespace nsfd
{
  namespace
  {
    /**
     * A vertex of some facets that comes into others. It is looked at from a
     * little inside its body, halfway between the places from which the search
     * looks at the points of its facets: what is inside there overlaps, and
     * boxes that stand flush do not.
     */
    template <int dim>
    class VertexOnTheWay
    {
    public:
      /** @p own: the facets at it, @p others: those that it may come into. */
      VertexOnTheWay(const Surfaces<dim> &surfaces,
                     const SweptSurfaces<dim> &swept, const unsigned int vertex,
                     const std::vector<unsigned int> &own,
                     const std::vector<unsigned int> &others)
          : surfaces_(surfaces), swept_(swept), vertex_(vertex), own_(own),
            others_(others)
      {
      }

      void look(std::optional<MissedContact<dim>> &first)
      {
        if (std::none_of(others_.begin(), others_.end(), [&](const auto f) {
              return swept_.way_past(vertex_, f) > safe(f);
            }))
          return;
        find_passages();
        for (auto it = passages_.cbegin(); it != passages_.cend(); ++it) {
          const unsigned int f = it->facet;
          const double way = swept_.way_past(vertex_, f);
          if (!it->inward || way <= safe(f) || is_harmless(it))
            continue;
          MissedContact<dim> missed;
          missed.share = std::min(1., it->begin + 0.5 * safe(f) / way);
          missed.body_1 = surfaces_.facets[f].body;
          missed.body_2 = surfaces_.facets[own_[0]].body;
          missed.place = at(it->begin);
          take_first(first, missed);
        }
      }

    private:
      /** Through the plane of a facet, between its ends. */
      struct Passage {
        double time = 0.,
               begin = 0.; ///< of the step; begin: of the vertex itself
        unsigned int facet = 0;
        bool inward = false;
      };

      double safe(const unsigned int f) const
      {
        double result = swept_.safe(f);
        for (const unsigned int own : own_)
          result = std::min(result, swept_.safe(own, f));
        return result;
      }
      double size(const unsigned int f) const
      {
        double result = swept_.first_plane(f).size;
        for (const unsigned int own : own_)
          result = std::min(result, swept_.first_plane(own).size);
        return result;
      }

      /** By how much the vertex is ahead of the inside, in parts of the step.
       */
      double lead(const unsigned int f) const
      {
        double largest = 0.;
        for (const unsigned int own : own_)
          largest = std::max(largest, swept_.first_plane(own).size);
        return inset * largest / swept_.way_past(vertex_, f);
      }

      Place<dim> at(const double time) const
      {
        const auto [k, s] = swept_.part_of(time);
        return swept_.part(k).at(vertex_, s);
      }
      double depth(const unsigned int f, const double time) const
      {
        const auto [k, s] = swept_.part_of(time);
        return -swept_.facet(f, k, s).height(at(time));
      }
      Place<dim> inside(const std::size_t k, const double s) const
      {
        const Place<dim> y = swept_.part(k).at(vertex_, s);
        Place<dim> result(y);
        for (const unsigned int own : own_)
          result = sum(result, inset / double(own_.size()),
                       difference(swept_.facet(own, k, s).plane.centre, y));
        return result;
      }

      void find_passages()
      {
        passages_.clear();
        const double n = double(swept_.n_parts());
        for (const unsigned int f : others_)
          for (std::size_t k = 0; k < swept_.n_parts(); ++k) {
            // polynomials: of the third degree, of the second in the plane
            const auto scaled = [&](const FacetOnTheWay<dim> &facet,
                                    const Place<dim> &y) {
              return facet.height(y) * std::pow(facet.plane.size, dim - 1);
            };
            const auto height = [&](const double s) {
              return scaled(swept_.facet(f, k, s), inside(k, s));
            };
            const auto height_itself = [&](const double s) {
              return scaled(swept_.facet(f, k, s),
                            swept_.part(k).at(vertex_, s));
            };
            const auto add = [&](const double s, const bool inward) {
              if (!swept_.facet(f, k, s).is_over(inside(k, s)))
                return;
              double begin = s;
              if (inward && height_itself(s) <= 0.) {
                begin = std::max(0., s - n * lead(f));
                visit_zeros(height_itself,
                            [&](const double t, const bool comes_in) {
                              if (comes_in && t <= s)
                                begin = std::max(begin, t);
                            });
              }
              passages_.push_back(
                  {(double(k) + s) / n, (double(k) + begin) / n, f, inward});
            };
            const double h = height(0.);
            if (k == 0 && h <= 0. &&
                h >= -2. * swept_.safe(f) *
                         std::pow(swept_.first_plane(f).size, dim - 1))
              add(0., true);
            visit_zeros(height, add);
          }
        std::sort(
            passages_.begin(), passages_.end(),
            [&](const Passage &a, const Passage &b) {
              return std::make_pair(a.time, surfaces_.facets[a.facet].key) <
                     std::make_pair(b.time, surfaces_.facets[b.facet].key);
            });
      }

      std::uint64_t whole(const unsigned int facet) const
      {
        return surfaces_.facets[facet].whole;
      }

      /** When it is deepest below facet @p f between two times. */
      double deepest_at(const unsigned int f, const double begin,
                        const double end) const
      {
        const double n = double(swept_.n_parts());
        double result = end, deepest_there = depth(f, end);
        for (std::size_t k = swept_.part_of(begin).first;
             k <= swept_.part_of(end).first; ++k) {
          const double first = std::max(begin, double(k) / n),
                       last = std::min(end, double(k + 1) / n);
          // below the plane between two zeros a cubic has one lowest place
          const auto height = [&](const double share) {
            return -depth(f, first + share * (last - first));
          };
          const double share = smallest_at(height);
          if (-height(share) > deepest_there) {
            deepest_there = -height(share);
            result = first + share * (last - first);
          }
        }
        return result;
      }

      /** Whether a search at that @p time would find it below facet @p f or
          what is next to this. */
      bool is_found(const unsigned int f, const double time) const
      {
        const auto [k, s] = swept_.part_of(time);
        const FacetOnTheWay<dim> entered = swept_.facet(f, k, s);
        const Place<dim> y = at(time), y_inside = inside(k, s);
        if (entered.height(y) >= -safe(f))
          return true;
        return std::any_of(
            others_.begin(), others_.end(), [&, k = k, s = s](const auto g) {
              const FacetOnTheWay<dim> next = swept_.facet(g, k, s);
              return whole(g) == whole(f) &&
                     dot(next.plane.normal, entered.plane.normal) > 0. &&
                     next.height(y) >= -safe(g) && next.is_over(y_inside) &&
                     std::any_of(own_.begin(), own_.end(), [&](const auto own) {
                       return dot(next.plane.normal,
                                  swept_.facet(own, k, s).plane.normal) <
                              opposed_below;
                     });
            });
      }

      /**
       * Hardly inside between in and out, or never deeper than a search finds
       * it: what is deeper on its way only would have been held before, and a
       * step that something else cuts may end there.
       */
      bool
      is_harmless(const typename std::vector<Passage>::const_iterator in) const
      {
        const unsigned int f = in->facet;
        const auto out =
            std::find_if(in, passages_.cend(), [&](const Passage &next) {
              return !next.inward && whole(next.facet) == whole(f);
            });
        const auto is_found_until = [&](const double end) {
          // what was inside at the start is held, as it was found then
          if (in->time == 0.)
            return true;
          if (!is_found(f, deepest_at(f, in->time, end)))
            return false;
          // deepest below f it may be next to the facet that it goes on to
          constexpr unsigned int looks = 16;
          for (unsigned int k = 1; k < looks; ++k)
            if (!is_found(f, in->time + (end - in->time) * k / looks))
              return false;
          return true;
        };
        if (out == passages_.cend())
          return is_found(f, 1.) && is_found_until(1.);
        if (out->facet == f)
          return is_found_until(out->time);
        const double middle = 0.5 * (in->time + out->time);
        const auto [k, s] = swept_.part_of(middle);
        // a corner, no passage from one side to the other
        return dot(swept_.facet(f, k, s).plane.normal,
                   swept_.facet(out->facet, k, s).plane.normal) >
                   opposed_below &&
               std::min(depth(f, middle), depth(out->facet, middle)) <
                   unseen * size(f);
      }

      const Surfaces<dim> &surfaces_;
      const SweptSurfaces<dim> &swept_;
      const unsigned int vertex_;
      const std::vector<unsigned int> &own_, &others_;
      std::vector<Passage> passages_; ///< by time
    };
  } // namespace

  template <int dim>
  void find_missed_points(const Surfaces<dim> &surfaces,
                          const SweptSurfaces<dim> &swept,
                          const BoxTree<dim> &tree, const PassingBodies &bodies,
                          std::optional<MissedContact<dim>> &first)
  {
    std::vector<unsigned int> order(surfaces.points.size()), own, others;
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](const unsigned int p) {
      const auto &point = surfaces.points[p];
      return std::make_pair(point.vertex, surfaces.facets[point.facet].body);
    };
    std::sort(order.begin(), order.end(), [&](const auto a, const auto b) {
      return std::make_pair(key(a), a) < std::make_pair(key(b), b);
    });
    for (std::size_t i = 0, end = 0; i < order.size(); i = end) {
      const auto [vertex, body] = key(order[i]);
      own.clear();
      double margin = 0.;
      for (; end < order.size() && key(order[end]) == key(order[i]); ++end) {
        own.push_back(surfaces.points[order[end]].facet);
        margin = std::max(margin, deepest * swept.first_plane(own.back()).size);
      }
      if (!bodies.is_own(body))
        continue;
      others.clear();
      // what is inside at the start came in through a facet that far away
      tree.near(swept.swept(&vertex, &vertex + 1, margin),
                [&, b = body](const auto &entry) {
                  if (bodies.may_touch(b, surfaces.facets[entry.second].body))
                    others.push_back(entry.second);
                });
      std::sort(others.begin(), others.end());
      if (!others.empty())
        VertexOnTheWay<dim>(surfaces, swept, vertex, own, others).look(first);
    }
  }

#define INSTANTIATE(dim)                                                       \
  template void find_missed_points<dim>(                                       \
      const Surfaces<dim> &, const SweptSurfaces<dim> &, const BoxTree<dim> &, \
      const PassingBodies &, std::optional<MissedContact<dim>> &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
