#include "ball_pairs.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    template <int dim>
    struct Near {
      FacetPair<dim> pair;
      double distance = 0.; ///< of the centre
    };

    /** The facets in front of which the centre is, within the gap. */
    template <int dim>
    bool near_facet(const typename Surfaces<dim>::Facet &facet,
                    const Plane<dim> &plane, const double *x,
                    const typename Surfaces<dim>::Ball &ball,
                    const double reach, Near<dim> &near)
    {
      const Place<dim> centre = place<dim>(x, ball.vertex);
      const auto foot = closest_place<dim>(facet, plane, x, centre);
      const Place<dim> way = difference(centre, foot.place);
      const double height = dot(plane.normal, way);
      near.distance = norm(way);
      near.pair.gap = near.distance - ball.radius;
      if (near.pair.gap > reach || height < -same_length * plane.size)
        return false;
      near.pair.normal = near.distance > same_length * ball.radius
                             ? sum({}, 1. / near.distance, way)
                             : plane.normal;
      near.pair.closest = foot.place;
      near.pair.weights = foot.weights;
      return true;
    }

    template <int dim>
    class NearFacets
    {
    public:
      NearFacets(const Surfaces<dim> &surfaces, const double *x,
                 const std::vector<Plane<dim>> &planes)
          : surfaces_(surfaces), x_(x), planes_(planes)
      {
      }

      /**
       * Whether b says all that a says: the place of a is on b as well, and b
       * either comes closer there or is the same place of the same body.
       */
      bool hides(const Near<dim> &a, const Near<dim> &b) const
      {
        const unsigned int f = b.pair.facet;
        const double rounding =
            same_length * std::max(planes_[a.pair.facet].size, planes_[f].size);
        const auto on_b = closest_place<dim>(surfaces_.facets[f], planes_[f],
                                             x_, a.pair.closest);
        if (norm(difference(on_b.place, a.pair.closest)) > rounding)
          return false;
        // on a flat floor the distance grows with the square of the offset
        if (norm(difference(b.pair.closest, a.pair.closest)) > rounding)
          return b.distance < a.distance;
        return body(a) == body(b) && key(b) < key(a);
      }

    private:
      unsigned int body(const Near<dim> &near) const
      {
        return surfaces_.facets[near.pair.facet].body;
      }
      std::uint64_t key(const Near<dim> &near) const
      {
        return surfaces_.facets[near.pair.facet].key;
      }

      const Surfaces<dim> &surfaces_;
      const double *x_;
      const std::vector<Plane<dim>> &planes_;
    };

    template <int dim>
    bool ball_pair(const Surfaces<dim> &surfaces, const double *x,
                   const double reach, BallPair<dim> &pair)
    {
      const auto &ball = surfaces.balls[pair.ball];
      const auto &other = surfaces.balls[pair.other];
      const Place<dim> centre = place<dim>(x, other.vertex);
      const Place<dim> way = difference(place<dim>(x, ball.vertex), centre);
      const double distance = norm(way);
      pair.gap = distance - ball.radius - other.radius;
      // balls with the same centre have no normal
      if (pair.gap > reach || !(distance > 0.))
        return false;
      pair.normal = sum({}, 1. / distance, way);
      pair.closest = sum(centre, other.radius, pair.normal);
      return true;
    }
  } // namespace

  template <int dim>
  void find_ball_pairs(const Surfaces<dim> &surfaces, const double *x,
                       const std::vector<Plane<dim>> &planes,
                       const double reach, const NearCandidates &candidates,
                       std::vector<FacetPair<dim>> &pairs)
  {
    pairs.clear();
    const NearFacets<dim> facets(surfaces, x, planes);
    const auto &lists = candidates.facets_of_balls;
    std::vector<Near<dim>> nears; // of one ball
    Near<dim> near;
    for (unsigned int b = 0; b < surfaces.balls.size(); ++b) {
      nears.clear();
      near.pair.index = b;
      for (std::size_t i = lists.first[b]; i < lists.first[b + 1]; ++i) {
        const unsigned int f = near.pair.facet = lists.entries[i];
        if (near_facet<dim>(surfaces.facets[f], planes[f], x, surfaces.balls[b],
                            reach, near))
          nears.push_back(near);
      }
      std::sort(nears.begin(), nears.end(), [&](const auto &l, const auto &r) {
        return surfaces.facets[l.pair.facet].key <
               surfaces.facets[r.pair.facet].key;
      });
      for (const auto &a : nears)
        if (std::none_of(nears.begin(), nears.end(), [&](const auto &c) {
              return &c != &a && facets.hides(a, c);
            }))
          pairs.push_back(a.pair);
    }
  }

  template <int dim>
  void find_ball_ball_pairs(const Surfaces<dim> &surfaces, const double *x,
                            const double reach,
                            const NearCandidates &candidates,
                            std::vector<BallPair<dim>> &pairs)
  {
    pairs.clear();
    const auto &lists = candidates.balls_of_balls;
    BallPair<dim> pair;
    for (pair.ball = 0; pair.ball < surfaces.balls.size(); ++pair.ball)
      for (std::size_t i = lists.first[pair.ball];
           i < lists.first[pair.ball + 1]; ++i) {
        pair.other = lists.entries[i];
        if (ball_pair<dim>(surfaces, x, reach, pair))
          pairs.push_back(pair);
      }
  }

#define INSTANTIATE(dim)                                                       \
  template void find_ball_pairs<dim>(                                          \
      const Surfaces<dim> &, const double *, const std::vector<Plane<dim>> &,  \
      double, const NearCandidates &, std::vector<FacetPair<dim>> &);          \
  template void find_ball_ball_pairs<dim>(                                     \
      const Surfaces<dim> &, const double *, double, const NearCandidates &,   \
      std::vector<BallPair<dim>> &)

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
