#pragma once

#include "nsfd/dynamics/bodies.h"

namespace nsfd
{
  /**
   * The longest step of the symplectic scheme on free bodies of this rank,
   * 2 / omega_max, in s; infinite if all are rigid. Joints, springs and
   * contacts are implicit in it and leave it as it is.
   */
  double stable_step(const Bodies &bodies);
} // namespace nsfd
