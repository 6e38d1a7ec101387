#pragma once

#include "communicator.h"

#include <functional>
#include <vector>

namespace nsfd
{
  /**
   * Rounds x := G(x) with the acceleration of Anderson over @p depth former
   * rounds (fixed point iteration of KINSOL in SUNDIALS). The vector consists
   * of the @p x of all ranks. @p round replaces x by G(x); it returns false
   * when it wants no more of them. Ends there, where x rests, or after
   * @p maximum rounds. Collective.
   *
   * What the rounds have reached is for the caller to judge: after the end
   * @p x is no more than the last mixture.
   */
  void
  accelerated_rounds(const Communicator &communicator, unsigned int depth,
                     unsigned int maximum, std::vector<double> &x,
                     const std::function<bool(std::vector<double> &)> &round);
} // namespace nsfd
