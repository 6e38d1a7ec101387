#pragma once

#include <cholmod.h>

namespace nsfd
{
  /** For supernodal factors, without messages of its own. */
  inline void start_cholmod(cholmod_common &common)
  {
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.print = 0;
    common.error_handler = nullptr;
  }
} // namespace nsfd
