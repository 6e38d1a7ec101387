#pragma once

#include "free_motion.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace nsfd
{
  class Archive;

  /**
   * How far forces are from balance, F + H^T r - K q, measured by the largest
   * forces that were present so far: what is broken may carry none at all.
   * Round-off of K q counts as a force.
   */
  template <int dim>
  class ForceBalance
  {
  public:
    ForceBalance(const DelassusOperator<dim> &delassus,
                 const FreeMotion<dim> &free_motion)
        : delassus_(delassus), free_motion_(free_motion)
    {
    }

    /**
     * A load step starts at @p q under the forces @p force of the points, whose
     * supports @p support are in N/m; it moves nothing by more than @p largest,
     * and is to be solved to @p tolerance. Collective.
     */
    void begin(const std::vector<double> &q, const std::vector<double> &force,
               const std::vector<double> &support, std::size_t n_owned,
               double largest, double tolerance);

    /** After a round to @p q that leaves over @p residual. Collective. */
    void measure(const std::vector<double> &q, std::vector<double> residual,
                 const std::vector<double> &force);
    /** M v/h, which the forces leave over in a step of @p h. Collective. */
    std::vector<double> left_over(double h,
                                  const std::vector<double> &velocity) const;

    /** |F + H^T r - K q| over the largest forces so far. */
    double imbalance() const { return imbalance_; }
    /** F + H^T r - K q at all unknowns. */
    const std::vector<double> &residual() const { return residual_; }
    /** The largest sum of r^2/support so far, or its round-off, J. */
    double point_scale() const;
    /** What imbalance() is measured by, N. */
    double largest_forces() const { return std::max(present_, round_off_); }
    void serialize(Archive &archive);

  private:
    std::pair<double, double>
    forces_present(const std::vector<double> &q,
                   const std::vector<double> &force,
                   const std::vector<double> &other) const;

    const DelassusOperator<dim> &delassus_;
    const FreeMotion<dim> &free_motion_;
    std::vector<double> residual_;
    double round_off_ = 0., point_round_off_ = 0.; ///< as the next two
    double present_ = 0.;     ///< largest forces at an equilibrium, N
    double point_scale_ = 0.; ///< largest sum of r^2/(w kappa), J
    double imbalance_ = 0.;
  };
} // namespace nsfd
