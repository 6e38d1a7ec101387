#pragma once

#include "box_tree.h"
#include "missed_contacts.h"
#include "straight_ways.h"
#include "touching_rules.h"

#include <limits>
#include <utility>

namespace nsfd
{
  /** Corners that overlap by less, in sizes of a facet, do not touch. */
  constexpr double unseen = 0.5 * inset;

  /** What all surfaces pass in a step; the last three live as long. */
  template <int dim>
  class SweptSurfaces
  {
  public:
    SweptSurfaces(const Surfaces<dim> &surfaces, const StepPath &path,
                  const std::vector<double> &thickness)
        : surfaces_(surfaces), path_(path), thickness_(thickness)
    {
      set_planes<dim>(surfaces, path.front(), planes_);
    }

    std::size_t n_parts() const { return path_.size() - 1; }
    StraightWay<dim> part(const std::size_t k) const
    {
      return {path_[k], path_[k + 1]};
    }
    /** A part and a place on it, of a time in parts of the step. */
    std::pair<std::size_t, double> part_of(const double time) const
    {
      const double n = double(n_parts()) * time;
      const std::size_t k = std::min(std::size_t(n), n_parts() - 1);
      return {k, n - double(k)};
    }
    FacetOnTheWay<dim> facet(const unsigned int f, const std::size_t k,
                             const double s) const
    {
      return FacetOnTheWay<dim>(surfaces_.facets[f], part(k), s);
    }
    const Plane<dim> &first_plane(const unsigned int f) const
    {
      return planes_[f];
    }

    /**
     * How deep in a facet something may be at the end of a step: the next
     * search finds what is twice as deep, as it may be after the step in which
     * the contact closes.
     */
    double safe(const unsigned int f) const
    {
      return 0.5 * std::min(deepest * planes_[f].size,
                            0.5 * thickness_[surfaces_.facets[f].body]);
    }
    /** Likewise, of a point of facet @p own in facet @p f. */
    double safe(const unsigned int own, const unsigned int f) const
    {
      return std::min(0.5 * deepest * planes_[own].size, safe(f));
    }
    double safe(const typename Surfaces<dim>::Ball &ball) const
    {
      return 0.5 *
             std::min(2. * deepest * ball.radius, 0.5 * thickness_[ball.body]);
    }

    /** How far two vertices move past each other. */
    double way(const unsigned int a, const unsigned int b) const
    {
      double result = 0.;
      for (std::size_t k = 0; k < n_parts(); ++k)
        result += norm(difference(
            difference(place<dim>(path_[k + 1], a), place<dim>(path_[k], a)),
            difference(place<dim>(path_[k + 1], b), place<dim>(path_[k], b))));
      return result;
    }
    double way_past(const unsigned int vertex, const unsigned int f) const
    {
      const auto &facet = surfaces_.facets[f];
      double result = 0.;
      for (unsigned int v = 0; v < facet.n_vertices; ++v)
        result = std::max(result, way(vertex, facet.vertex[v]));
      return result;
    }

    /** The box of all that some vertices pass. */
    template <typename Vertices>
    Box<dim> swept(const Vertices &begin, const Vertices &end,
                   const double margin) const
    {
      Place<dim> low = place<dim>(path_[0], *begin), high = low;
      for (const double *const x : path_)
        for (auto v = begin; v != end; ++v)
          for (int d = 0; d < dim; ++d) {
            const double value = x[std::size_t(*v) * dim + d];
            low[d] = std::min(low[d], value);
            high[d] = std::max(high[d], value);
          }
      return box_around<dim>(low, high, margin);
    }

    /** Nothing is fast enough, whatever it meets. */
    bool all_slow() const
    {
      constexpr double none = std::numeric_limits<double>::infinity();
      double least = none;
      for (unsigned int f = 0; f < planes_.size(); ++f)
        least = std::min(least, safe(f));
      for (const auto &ball : surfaces_.balls)
        least = std::min(least, safe(ball));
      // no two pass each other by more than the sum over the parts
      double way = 0.;
      for (std::size_t k = 0; k < n_parts() && !(way > least); ++k)
        way += largest_way(k);
      return !(way > least);
    }

  private:
    /** No two vertices pass each other by more in a part; nothing: 0. */
    double largest_way(const std::size_t k) const
    {
      constexpr double none = std::numeric_limits<double>::infinity();
      Place<dim> low, high;
      low.fill(none);
      high.fill(-none);
      const auto look_at = [&](const unsigned int vertex) {
        const Place<dim> u = difference(place<dim>(path_[k + 1], vertex),
                                        place<dim>(path_[k], vertex));
        for (int d = 0; d < dim; ++d) {
          low[d] = std::min(low[d], u[d]);
          high[d] = std::max(high[d], u[d]);
        }
      };
      for (const auto &facet : surfaces_.facets)
        for (unsigned int v = 0; v < facet.n_vertices; ++v)
          look_at(facet.vertex[v]);
      for (const auto &ball : surfaces_.balls)
        look_at(ball.vertex);
      return low[0] > high[0] ? 0. : norm(difference(high, low));
    }

    const Surfaces<dim> &surfaces_;
    const StepPath &path_;
    const std::vector<double> &thickness_;
    std::vector<Plane<dim>> planes_; ///< at the start
  };

  /** Which bodies may miss which others in a step. */
  struct PassingBodies {
    const std::function<bool(unsigned int)> &is_own;
    const AreJoined &joined;

    bool may_touch(const unsigned int a, const unsigned int b) const
    {
      return a != b && !joined(a, b);
    }
  };

  /** Of points in facets; @p tree has what the facets pass. */
  template <int dim>
  void find_missed_points(const Surfaces<dim> &surfaces,
                          const SweptSurfaces<dim> &swept,
                          const BoxTree<dim> &tree, const PassingBodies &bodies,
                          std::optional<MissedContact<dim>> &first);

  /** Of balls and facets, and of two balls. */
  template <int dim>
  void find_missed_balls(const Surfaces<dim> &surfaces,
                         const SweptSurfaces<dim> &swept,
                         const BoxTree<dim> &tree, const PassingBodies &bodies,
                         std::optional<MissedContact<dim>> &first);

  /** Of two edges; none in the plane. */
  template <int dim>
  void find_missed_edges(const Surfaces<dim> &surfaces,
                         const SweptSurfaces<dim> &swept,
                         const PassingBodies &bodies,
                         std::optional<MissedContact<dim>> &first);
} // namespace nsfd
