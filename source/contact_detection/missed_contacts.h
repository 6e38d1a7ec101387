#pragma once

#include "surface_search.h"

#include <optional>

namespace nsfd
{
  /**
   * A contact that a step has passed over: something has come into a body and
   * is so deep inside at the end, or out again, that the next search would not
   * find it where it came in.
   */
  template <int dim>
  struct MissedContact {
    /// body_1 from here on is an obstacle
    static constexpr unsigned int first_obstacle = 1u << 31;

    double share = 1.; ///< of the step: one as long ends just inside
    unsigned int body_1 = 0, body_2 = 0;
    std::array<double, dim> place{}; ///< where it came in
  };

  /** The one that asks for the shorter step, whatever their order. */
  template <int dim>
  void take_first(std::optional<MissedContact<dim>> &first,
                  const MissedContact<dim> &other);

  /**
   * Coordinates of all vertices at the start of a step, at its end and perhaps
   * at equal parts in between; from one to the next everything moves straight.
   */
  using StepPath = std::vector<const double *>;

  /**
   * Continuous detection, of points in facets, edges across edges and balls of
   * all bodies that @p is_own says. What moves past each other by less than an
   * eighth of the smaller facet, and a quarter of the @p thickness of a body,
   * in a step cannot be missed; if there is nothing else, that is found out
   * first.
   */
  template <int dim>
  std::optional<MissedContact<dim>>
  first_missed(const Surfaces<dim> &surfaces, const StepPath &path,
               const std::vector<double> &thickness,
               const std::function<bool(unsigned int)> &is_own,
               const AreJoined &joined);
} // namespace nsfd
