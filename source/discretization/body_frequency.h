#pragma once

#include "bodies.h"

#include <array>

namespace nsfd
{
  /** Largest eigenvalue of a symmetric matrix and its last component. */
  std::array<double, 2> largest_eigenpair(const Block &A);

  /** omega_max of a free body, rad/s; 0 of a rigid one. */
  double highest_frequency(const BodyClass &body);
} // namespace nsfd
