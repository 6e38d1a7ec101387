#include "point_pairs.h"

#include "touching_rules.h"

#include <algorithm>
#include <limits>

namespace nsfd
{
  namespace
  {
    template <int dim>
    struct Touch {
      FacetPair<dim> pair;
      double opposed = 0.;  ///< cosine between the two outward normals
      bool is_kept = false; ///< the side of the last step
      bool cuts = false;    ///< like a blade of scissors: both tips are outside
    };

    template <int dim>
    class PointTouches
    {
    public:
      PointTouches(const Surfaces<dim> &surfaces, const double *x,
                   const std::vector<Plane<dim>> &planes, const double reach,
                   const NearCandidates &candidates)
          : surfaces_(surfaces), x_(x), planes_(planes), reach_(reach),
            next_(candidates.next_facets)
      {
      }

      /** Adds the touch of a point that has one among its candidates. */
      void add(const unsigned int p, const unsigned int *begin,
               const unsigned int *end, std::vector<Touch<dim>> &touches)
      {
        valid_.clear();
        const auto &point = surfaces_.points[p];
        const Plane<dim> &own = planes_[point.facet];
        beside_ = beside(point);
        const Place<dim> y = place<dim>(x_, point.vertex);
        const Place<dim> to_centre = difference(own.centre, y);
        const Place<dim> inside = sum(y, inset, to_centre);
        Touch<dim> touch;
        touch.pair.index = p;
        touch.pair.inset = inset * norm(to_centre);
        for (; begin != end; ++begin) {
          touch.is_kept = surfaces_.facets[*begin].side == point.last_side;
          if (!touches_facet(own, *begin, y, inside, touch))
            continue;
          // such a tip has not come through the facet, but through another one
          // or none; deeper than this it would have been seen before
          touch.cuts = touch.cuts &&
                       (touch.is_kept || -touch.pair.gap <= touch.pair.inset);
          (touch.cuts ? touches : valid_).push_back(touch);
        }
        if (valid_.empty())
          return;
        if (valid_.size() == 1)
          touches.push_back(valid_.front());
        else
          add_of_wholes(same_length * own.size, touches);
      }

      /**
       * Two points of a vertex that is inside the same body: it has come
       * through one facet only, that of the last step or else the nearer one.
       * Otherwise a corner that slides over an edge by a hair is caught by the
       * side.
       */
      bool yields(const Touch<dim> &a, const Touch<dim> &b) const
      {
        const auto &facet_a = surfaces_.facets[a.pair.facet];
        const auto &facet_b = surfaces_.facets[b.pair.facet];
        // what is_outside() takes to lie on the other facet, or less deep
        const double rounding =
            same_length * std::max(own_size(a), own_size(b));
        if (facet_a.whole != facet_b.whole || a.cuts || b.cuts ||
            std::max(a.pair.gap, b.pair.gap) > rounding || notch(a, b))
          return false;
        if (a.is_kept != b.is_kept)
          return b.is_kept;
        if (std::abs(a.pair.gap - b.pair.gap) > rounding)
          return a.pair.gap < b.pair.gap;
        if (std::abs(a.opposed - b.opposed) > same_length)
          return a.opposed > b.opposed;
        return key_of_own(a) > key_of_own(b);
      }

    private:
      /** One of every whole: next to one that it slides on it meets others. */
      void add_of_wholes(const double rounding,
                         std::vector<Touch<dim>> &touches)
      {
        wholes_.clear();
        for (const auto &touch : valid_)
          wholes_.push_back(surfaces_.facets[touch.pair.facet].whole);
        std::sort(wholes_.begin(), wholes_.end());
        wholes_.erase(std::unique(wholes_.begin(), wholes_.end()),
                      wholes_.end());
        for (const unsigned int whole : wholes_) {
          of_whole_.clear();
          for (const auto &touch : valid_)
            if (surfaces_.facets[touch.pair.facet].whole == whole)
              of_whole_.push_back(touch);
          touches.push_back(*kept(best(of_whole_, rounding)));
        }
      }

      /** The facet beside that of a point, at the point, if there is one. */
      unsigned int next_at(const typename Surfaces<dim>::Point &point) const
      {
        if (dim == 3 || next_.empty())
          return NearCandidates::no_facet;
        const auto &ends = surfaces_.facets[point.facet].vertex;
        return next_[point.facet][ends[0] == point.vertex ? 0 : 1];
      }
      const Plane<dim> *beside(const typename Surfaces<dim>::Point &point) const
      {
        const unsigned int next = next_at(point);
        return next == NearCandidates::no_facet ? nullptr : &planes_[next];
      }

      /** -normal = a own + b beside with a, b >= 0. */
      bool in_cone(const Plane<dim> &own, const Place<dim> &normal) const
      {
        const Place<dim> &c = own.normal, &d = beside_->normal;
        const auto area = [](const Place<dim> &a, const Place<dim> &b) {
          return a[0] * b[1] - a[1] * b[0];
        };
        const double all = area(c, d);
        return area(d, normal) * all >= 0. && area(normal, c) * all >= 0.;
      }

      bool touches_facet(const Plane<dim> &own, const unsigned int f,
                         const Place<dim> &y, const Place<dim> &inside,
                         Touch<dim> &touch) const
      {
        const Plane<dim> &plane = planes_[f];
        touch.opposed = dot(own.normal, plane.normal);
        if (!(touch.opposed < opposed_below))
          return false;
        // what has come in stays there while it turns
        const bool stays = touch.is_kept &&
                           surfaces_.points[touch.pair.index].was_below,
                   fits = !beside_ || touch.opposed < face_to_face ||
                          in_cone(own, plane.normal);
        if (!fits && !stays)
          return false;
        const double depth = deepest * std::min(own.size, plane.size);
        if (dim == 2 &&
            !within(dot(plane.normal, difference(y, plane.centre)), depth))
          return false;
        const auto &facet = surfaces_.facets[f];
        // what is inside stays below its facet to the very end of it
        if (!projects_into<dim>(facet, plane, x_, inside) &&
            !(touch.is_kept && projects_into<dim>(facet, plane, x_, y)))
          return false;
        const auto foot = extended_place<dim>(facet, plane, x_, y);
        touch.pair.facet = f;
        touch.pair.gap = dot(plane.normal, difference(y, foot.place));
        touch.pair.normal = plane.normal;
        touch.pair.closest = foot.place;
        touch.pair.weights = foot.weights;
        touch.is_kept = touch.is_kept && touch.pair.gap <= 0.;
        touch.cuts = false;
        if (!(fits || touch.is_kept) || !within(touch.pair.gap, depth))
          return false;
        const double rounding = same_length * own.size;
        if (!(touch.pair.gap < -rounding))
          return true;
        if (is_outside(f, y, foot.place, touch.is_kept, rounding)) {
          touch.cuts = cuts(touch.pair.index, f);
          if (!touch.cuts)
            return false;
        }
        return touch.is_kept || !came_through_next(touch, y);
      }

      /**
       * Below a facet and, less deep, below the next one, which a side of this
       * corner looks at that touches nothing itself yet.
       */
      bool came_through_next(const Touch<dim> &touch, const Place<dim> &y) const
      {
        const unsigned int other = next_at(surfaces_.points[touch.pair.index]);
        if (other == NearCandidates::no_facet ||
            surfaces_.facets[other].touches)
          return false;
        for (const unsigned int next : next_[touch.pair.facet]) {
          if (next == NearCandidates::no_facet)
            continue;
          const Plane<dim> &plane = planes_[next];
          const double height = dot(plane.normal, difference(y, plane.centre));
          if (height <= 0. && height > touch.pair.gap &&
              dot(plane.normal, planes_[other].normal) < opposed_below &&
              projects_into<dim>(surfaces_.facets[next], plane, x_, y))
            return true;
        }
        return false;
      }

      /**
       * Below a facet, but in front of the next one, beyond the end that they
       * share or with this next one between the point and the facet: through
       * the tip of an acute corner. In space edges say so, see
       * settle_touches().
       */
      bool is_outside(const unsigned int f, const Place<dim> &y,
                      const Place<dim> &foot, const bool is_kept,
                      const double rounding) const
      {
        if (dim == 3 || next_.empty())
          return false;
        const auto &ends = surfaces_.facets[f].vertex;
        for (unsigned int v = 0; v < 2; ++v) {
          if (next_[f][v] == NearCandidates::no_facet)
            continue;
          const Plane<dim> &next = planes_[next_[f][v]];
          const double height = dot(next.normal, difference(y, next.centre));
          if (!(height > rounding))
            continue;
          const Place<dim> end = place<dim>(x_, ends[v]);
          const bool past =
              dot(difference(y, end), difference(end, planes_[f].centre)) > 0.;
          // what came in through the facet is held there until it is past it
          if (past || (!is_kept && crosses(next_[f][v], y, foot)))
            return true;
        }
        return false;
      }

      /**
       * Two acute corners pass through each other like the blades of scissors:
       * both tips are outside, and a side at point @p p leads through facet
       * @p f, whose tip is in front of the other side there.
       */
      bool cuts(const unsigned int p, const unsigned int f) const
      {
        const auto &point = surfaces_.points[p];
        const std::array<unsigned int, 2> sides = {point.facet, next_at(point)};
        if (sides[1] == NearCandidates::no_facet)
          return false;
        const Place<dim> y = place<dim>(x_, point.vertex);
        for (unsigned int i = 0; i < 2; ++i) {
          const auto &ends = surfaces_.facets[sides[i]].vertex;
          const Place<dim> other =
              place<dim>(x_, ends[ends[0] == point.vertex ? 1 : 0]);
          if (!crosses(f, other, y) && !lies_on(f, other))
            continue;
          const Plane<dim> &beside = planes_[sides[1 - i]];
          for (unsigned int v = 0; v < 2; ++v) {
            const unsigned int next = next_[f][v];
            if (next == NearCandidates::no_facet ||
                !(dot(planes_[next].normal,
                      difference(y, planes_[next].centre)) > 0.))
              continue;
            const Place<dim> tip =
                place<dim>(x_, surfaces_.facets[f].vertex[v]);
            // below the side that cuts, too
            if (dot(beside.normal, difference(tip, y)) > 0. &&
                dot(planes_[sides[i]].normal, difference(tip, y)) < 0.)
              return true;
          }
        }
        return false;
      }

      /** Below facet @p f, as deep as a touch may be, and between its ends. */
      bool lies_on(const unsigned int f, const Place<dim> &y) const
      {
        const Plane<dim> &plane = planes_[f];
        const double height = dot(plane.normal, difference(y, plane.centre));
        return height <= 0. && height >= -deepest * plane.size &&
               projects_into<dim>(surfaces_.facets[f], plane, x_, y);
      }

      /** The way from in front of facet @p f to @p foot goes through it. */
      bool crosses(const unsigned int f, const Place<dim> &y,
                   const Place<dim> &foot) const
      {
        const Plane<dim> &plane = planes_[f];
        const double height = dot(plane.normal, difference(y, plane.centre)),
                     of_foot =
                         dot(plane.normal, difference(foot, plane.centre));
        if (!(of_foot < 0. && height > 0.))
          return false;
        const Place<dim> there =
            sum(y, height / (height - of_foot), difference(foot, y));
        const auto &ends = surfaces_.facets[f].vertex;
        const Place<dim> a = place<dim>(x_, ends[0]),
                         side = difference(place<dim>(x_, ends[1]), a);
        const double along = dot(difference(there, a), side);
        return along >= 0. && along <= dot(side, side);
      }

      bool within(const double gap, const double depth) const
      {
        return gap >= -depth && gap <= reach_;
      }

      /**
       * Smallest |gap|, then most opposed, then key. Each round keeps all that
       * are equal up to round-off: the order of the candidates has no say.
       */
      const Touch<dim> *best(const std::vector<Touch<dim>> &among,
                             const double rounding) const
      {
        double gap = std::numeric_limits<double>::max(), opposed = 1.;
        for (const auto &touch : among)
          gap = std::min(gap, std::abs(touch.pair.gap));
        for (const auto &touch : among)
          if (std::abs(touch.pair.gap) <= gap + rounding)
            opposed = std::min(opposed, touch.opposed);
        const Touch<dim> *result = nullptr;
        for (const auto &touch : among)
          if (std::abs(touch.pair.gap) <= gap + rounding &&
              touch.opposed <= opposed + same_length &&
              (!result || key(touch.pair.facet) < key(result->pair.facet)))
            result = &touch;
        return result;
      }

      /**
       * A point that is inside a body came in through the facet that it was
       * over in the last step, also where it is nearer to another one now: next
       * to a corner depths do not tell.
       */
      const Touch<dim> *kept(const Touch<dim> *nearest) const
      {
        const auto whole = [this](const Touch<dim> &touch) {
          return surfaces_.facets[touch.pair.facet].whole;
        };
        for (const auto &touch : valid_)
          if (touch.is_kept && nearest->pair.gap <= 0. &&
              whole(touch) == whole(*nearest))
            return &touch;
        return nearest;
      }

      /** Facets that look at each other: a vertex may touch both. */
      bool notch(const Touch<dim> &a, const Touch<dim> &b) const
      {
        const Plane<dim> &plane_a = planes_[a.pair.facet],
                         &plane_b = planes_[b.pair.facet];
        const Place<dim> way = difference(plane_b.centre, plane_a.centre);
        const double rounding = same_length * norm(way);
        return dot(plane_a.normal, way) > rounding &&
               dot(plane_b.normal, way) < -rounding;
      }

      std::uint64_t key(const unsigned int f) const
      {
        return surfaces_.facets[f].key;
      }
      std::uint64_t key_of_own(const Touch<dim> &touch) const
      {
        return key(surfaces_.points[touch.pair.index].facet);
      }
      double own_size(const Touch<dim> &touch) const
      {
        return planes_[surfaces_.points[touch.pair.index].facet].size;
      }

      const Surfaces<dim> &surfaces_;
      const double *x_;
      const std::vector<Plane<dim>> &planes_;
      double reach_;
      const std::vector<std::array<unsigned int, 2>> &next_; ///< facets
      std::vector<Touch<dim>> valid_, of_whole_;
      std::vector<unsigned int> wholes_;
      const Plane<dim> *beside_ = nullptr; ///< of the point at hand
    };
  } // namespace

  template <int dim>
  void find_point_pairs(const Surfaces<dim> &surfaces, const double *x,
                        const std::vector<Plane<dim>> &planes,
                        const double reach, const NearCandidates &candidates,
                        std::vector<FacetPair<dim>> &pairs)
  {
    pairs.clear();
    PointTouches<dim> points(surfaces, x, planes, reach, candidates);
    const auto &order = candidates.order;
    const auto &lists = candidates.facets_of_points;
    std::vector<Touch<dim>> touches; // of one vertex
    for (std::size_t i = 0, end = 0; i < order.size(); i = end) {
      const unsigned int vertex = surfaces.points[order[i]].vertex;
      touches.clear();
      for (; end < order.size() && surfaces.points[order[end]].vertex == vertex;
           ++end)
        if (lists.first[end] != lists.first[end + 1])
          points.add(order[end], &lists.entries[lists.first[end]],
                     lists.entries.data() + lists.first[end + 1], touches);
      for (const auto &touch : touches)
        if (std::none_of(
                touches.begin(), touches.end(), [&](const Touch<dim> &other) {
                  return &other != &touch && points.yields(touch, other);
                }))
          pairs.push_back(touch.pair);
    }
  }

#define INSTANTIATE(dim)                                                       \
  template void find_point_pairs<dim>(                                         \
      const Surfaces<dim> &, const double *, const std::vector<Plane<dim>> &,  \
      double, const NearCandidates &, std::vector<FacetPair<dim>> &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
