#pragma once

#include "bodies.h"

#include <algorithm>
#include <array>

namespace nsfd
{
  /** Where a point sits in one of its bodies. */
  struct PointPlace {
    int body = -1;         ///< local, -1: none or on another rank
    unsigned int slot = 0; ///< within the body
  };

  /**
   * @p visit (body, slot, point, side) for every point on every body of this
   * rank; side 1 is body 2. @p n_points is the number of points.
   */
  template <typename Visit>
  void for_all_places(const Bodies &bodies, const std::size_t n_points,
                      Visit &&visit)
  {
    const auto slot_of = [&](const std::size_t body, const std::size_t slot) {
      return unsigned(slot - bodies.first_slot[body]);
    };
    for (std::size_t b = 0; b < bodies.size(); ++b)
      for (std::size_t s = bodies.first_slot[b]; s < bodies.first_slot[b + 1];
           ++s)
        if (bodies.slot_point[s] < n_points)
          visit(b, slot_of(b, s), bodies.slot_point[s],
                unsigned(bodies.slot_sign[s] > 0));
    for (const auto &[slot, point] : bodies.extra_points) {
      const std::size_t b =
          std::size_t(std::upper_bound(bodies.first_slot.begin(),
                                       bodies.first_slot.end(), slot) -
                      bodies.first_slot.begin()) -
          1;
      visit(b, slot_of(b, slot), point, 1u);
    }
  }

  /** The places of every point in body 1 and in body 2. */
  inline std::array<std::vector<PointPlace>, 2>
  point_places(const Bodies &bodies, const std::size_t n_points)
  {
    std::array<std::vector<PointPlace>, 2> places;
    places.fill(std::vector<PointPlace>(n_points));
    for_all_places(bodies, n_points,
                   [&](const std::size_t body, const unsigned int slot,
                       const std::size_t point, const unsigned int side) {
                     places[side][point] = {int(body), slot};
                   });
    return places;
  }
} // namespace nsfd
