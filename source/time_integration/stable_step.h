#pragma once

#include "discretization/bodies.h"

namespace nsfd
{
  /**
   * The longest step of the explicit scheme on free bodies of this rank,
   * 2 / omega_max, in s; infinite if all are rigid. Joints, springs and
   * contacts are implicit in it and leave it as it is, and no frequency of
   * bodies that share nodes is above the largest of the single ones.
   */
  double stable_step(const Bodies &bodies);
} // namespace nsfd
