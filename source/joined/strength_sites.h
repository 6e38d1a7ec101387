#pragma once

#include "discretization/bodies.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace nsfd
{
  /**
   * Faces that may be released: where the mean traction of both sides is
   * compared with a strength. A site is a face (its points are released
   * together, the traction is averaged along it), or a point of cells of higher
   * degree. Most are far below their strength most of the time, and cost
   * nothing then: they are found by the largest traction in blocks of cells.
   */
  template <int dim>
  class StrengthSites
  {
  public:
    /// share of its strength from which on the traction of a site is computed
    static constexpr double looked_at = 0.6;
    /// one after the other have one bound
    static constexpr unsigned int cells_of_block = 8;

    struct Site {
      unsigned int first_point = 0, n_points = 1;
      std::array<unsigned int, 2> cells{};
      double shear_weight = 1.; ///< of |t_T|^2 beside <t_N>_+^2
      double limit = 0.; ///< square of the strength, Pa^2; infinite: released
      double least = 0.; ///< no smaller square of a traction reaches it, Pa^2
    };

    /** @p points outlive it. */
    explicit StrengthSites(const InterfacePoints<dim> &points) : points_(points)
    {
    }

    void reserve(const std::size_t n) { sites_.reserve(n); }
    void add(const Site &site) { sites_.push_back(site); }
    /** After all are there: which ones the blocks of @p n_cells have. */
    void finish(std::size_t n_cells);

    std::size_t size() const { return sites_.size(); }
    const Site &operator[](const std::size_t site) const
    {
      return sites_[site];
    }
    bool is_released(const std::size_t site) const
    {
      return sites_[site].limit == std::numeric_limits<double>::infinity();
    }
    /** It is not looked at any more. */
    void release(std::size_t site);
    /** Sites that are not released have others; @p limits of all of them. */
    struct Limits {
      double limit = 0., least = 0.; ///< see Site
    };
    void set_limits(const std::vector<Limits> &limits);

    /** Some sites, ascending, and squares of their tractions, Pa^2. */
    struct Near {
      std::vector<unsigned int> site;
      std::vector<double> square;
    };
    /**
     * Those whose traction may be beyond `looked_at` of their strength: where
     * one of the @p bounds on the squares in blocks of cells is. Squares are
     * 0 to begin with.
     */
    void find(const std::vector<double> &bounds, Near &near) const;
    /** The same where @p bound is of each of @p n_cells cells. */
    template <typename Bound>
    void find_by_cell(const std::size_t n_cells, const Bound &bound,
                      Near &near) const
    {
      std::vector<double> bounds(least_.size(), 0.);
      for (std::size_t cell = 0; cell < n_cells; ++cell)
        bounds[cell / cells_of_block] =
            std::max(bounds[cell / cells_of_block], bound(cell));
      find(bounds, near);
    }

    /** <t_N>_+^2 + shear_weight |t_T|^2 of a traction @p t at a site, Pa^2. */
    double square(const std::size_t site,
                  const std::array<double, dim> &t) const
    {
      const double *const n = normal(site);
      double sum = 0., pull = 0.;
      for (unsigned int c = 0; c < dim; ++c) {
        sum += t[c] * t[c];
        pull += t[c] * n[c];
      }
      return (pull > 0. ? pull * pull : 0.) +
             sites_[site].shear_weight * (sum - pull * pull);
    }
    /** From body 1 to body 2. */
    const double *normal(const std::size_t site) const
    {
      return points_.axes(sites_[site].first_point);
    }

  private:
    void set_least(std::size_t block);

    const InterfacePoints<dim> &points_;
    std::vector<Site> sites_;
    /// by block: its sites, those between two blocks twice
    std::vector<unsigned int> first_of_block_, of_block_;
    std::vector<double> least_; ///< by block: of those that are not released
    mutable std::vector<std::uint64_t> marks_; ///< a bit per site, in find()
  };
} // namespace nsfd
