#pragma once

#include <cstdint>

namespace nsfd
{
  /** What a point is during one step: decided before it, data afterwards. */
  enum class PointKind : std::uint8_t {
    prescribed, ///< U = U_given in the components of the mask (rigid joints,
                ///< supports); the other components carry nothing
    elastic,    ///< two-sided spring, no damage
    cohesive,   ///< intrinsic, or extrinsic after activation
    rigid,      ///< extrinsic before activation: U = 0 up to the strength
    free,       ///< contact and friction only, beta = 0
    bonded,     ///< its sides have common nodes and no impulse
    separated   ///< broken, its crack faces are left to the search for contacts
  };

  /** Its two sides are one body: there is no jump, or none that changes. */
  inline bool is_joined(const PointKind kind)
  {
    return kind == PointKind::bonded || kind == PointKind::rigid ||
           kind == PointKind::prescribed;
  }

  /** Not what common nodes join, nor what other points carry. */
  inline bool has_impulse(const PointKind kind)
  {
    return kind != PointKind::bonded && kind != PointKind::separated;
  }
} // namespace nsfd
