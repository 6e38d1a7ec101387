#include "surface_search.h"

#include "ball_pairs.h"
#include "core/gather.h"
#include "edge_pairs.h"
#include "near_candidates.h"
#include "point_pairs.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace nsfd
{
  namespace
  {
    bool any_body(unsigned int) { return true; }

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
  void SurfaceSearch<dim>::share(const Communicator &communicator,
                                 std::function<bool(unsigned int)> is_own)
  {
    all_ = communicator.size() > 1 ? &communicator : nullptr;
    is_own_ = std::move(is_own);
    topology_changed();
  }

  /** Those of all ranks, in the order in which one rank alone finds them. */
  template <int dim>
  void SurfaceSearch<dim>::gather_pairs(const Surfaces<dim> &surfaces,
                                        NearPairs<dim> &pairs) const
  {
    const auto join = [this](auto &own, const auto &comes_before) {
      own = gather_all(*all_, own);
      // those of one body come from one rank, in order
      std::stable_sort(own.begin(), own.end(), comes_before);
    };
    const auto vertex = [&](const auto &pair) {
      return surfaces.points[pair.index].vertex;
    };
    join(pairs.points, [&](const auto &a, const auto &b) {
      return std::pair(vertex(a), a.index) < std::pair(vertex(b), b.index);
    });
    if (!surfaces.balls.empty()) {
      join(pairs.balls,
           [](const auto &a, const auto &b) { return a.index < b.index; });
      join(pairs.ball_balls, [](const auto &a, const auto &b) {
        return std::tie(a.ball, a.other) < std::tie(b.ball, b.other);
      });
    }
    if (!surfaces.edges.empty())
      join(pairs.edges, [](const auto &a, const auto &b) {
        return std::tie(a.edge, a.other) < std::tie(b.edge, b.other);
      });
  }

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
                                const double reach, const AreJoined &joined,
                                NearPairs<dim> &pairs)
  {
    set_planes<dim>(surfaces, x, planes_);
    if (!candidates_hold(surfaces, x, reach)) {
      skin_ = skin_of<dim>(surfaces, planes_);
      candidates_ = search_candidates<dim>(surfaces, x, planes_, reach, skin_,
                                           all_ ? is_own_ : any_body, joined);
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
    find_crossings<dim>(surfaces, x, planes_, reach, candidates_, pairs.edges);
    if (all_)
      gather_pairs(surfaces, pairs);
    settle_touches<dim>(surfaces, x, planes_, pairs.points, pairs.edges);
  }

  template class SurfaceSearch<2>;
  template class SurfaceSearch<3>;
} // namespace nsfd
