#include "nsfd/contact/surface_search.h"

#include "ball_pairs.h"
#include "edge_pairs.h"
#include "near_candidates.h"
#include "point_pairs.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    template <int dim>
    std::array<std::size_t, 4> sizes_of(const Surfaces<dim> &surfaces)
    {
      return {surfaces.facets.size(), surfaces.points.size(),
              surfaces.balls.size(), surfaces.edges.size()};
    }

    template <int dim>
    double largest_square_motion(const double *x,
                                 const std::vector<double> &old)
    {
      double result = 0.;
      for (std::size_t i = 0; i < old.size(); i += dim) {
        double square = 0.;
        for (int d = 0; d < dim; ++d)
          square += (x[i + d] - old[i + d]) * (x[i + d] - old[i + d]);
        result = std::max(result, square);
      }
      return result;
    }
  } // namespace

  template <int dim>
  bool SurfaceSearch<dim>::candidates_hold(const Surfaces<dim> &surfaces,
                                           const double *x,
                                           const double reach) const
  {
    if (searched_at_.empty() ||
        searched_at_.size() != surfaces.n_vertices * dim ||
        searched_sizes_ != sizes_of(surfaces))
      return false;
    // a longer reach uses up the skin like motion does
    const double free = skin_ - std::max(0., reach - searched_reach_);
    return free >= 0. &&
           4. * largest_square_motion<dim>(x, searched_at_) <= free * free;
  }

  template <int dim>
  void SurfaceSearch<dim>::find(const Surfaces<dim> &surfaces, const double *x,
                                const double reach, const JoinedBodies &joined,
                                NearPairs<dim> &pairs)
  {
    set_planes<dim>(surfaces, x, planes_);
    if (!candidates_hold(surfaces, x, reach)) {
      skin_ = skin_of<dim>(surfaces, planes_);
      candidates_ =
          search_candidates<dim>(surfaces, x, planes_, reach, skin_, joined);
      searched_at_.assign(x, x + surfaces.n_vertices * dim);
      searched_sizes_ = sizes_of(surfaces);
      searched_reach_ = reach;
      ++n_searches_;
    }
    find_point_pairs<dim>(surfaces, x, planes_, reach, candidates_,
                          pairs.points);
    find_ball_pairs<dim>(surfaces, x, planes_, reach, candidates_, pairs.balls);
    find_ball_ball_pairs<dim>(surfaces, x, reach, candidates_,
                              pairs.ball_balls);
    find_edge_pairs<dim>(surfaces, x, planes_, reach, candidates_, pairs.points,
                         pairs.edges);
  }

  template class SurfaceSearch<2>;
  template class SurfaceSearch<3>;
} // namespace nsfd
