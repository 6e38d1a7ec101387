#pragma once

#include "run_law.h"

namespace nsfd
{
  /**
   * `nsfd law --contract`: what every law must keep, tried on the laws of a
   * file, or on all examples of a registered law. @return the exit code
   */
  int try_contract(const LawCommand &command);
} // namespace nsfd
