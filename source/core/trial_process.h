#pragma once

#include "lock_process.h"

#include <functional>
#include <string>

namespace nsfd
{
  /** What a copy of this process has left. */
  struct CopyAnswer {
    std::string bytes; ///< what its work has returned
    /// what ended it before: "signal 11, Segmentation fault", "more than 20 s",
    /// "more than 4.0 GiB of memory"; empty if nothing did
    std::string end;
  };

  /**
   * Do @p work in a copy of this process that has @p limits, is silent and can
   * write to nobody else: for libraries that a damaged file leads out of their
   * memory. @p work throws nothing; whoever takes its answer checks it.
   * Errors raised: std::system_error where no process can be started.
   */
  CopyAnswer ask_a_copy(const std::function<std::string()> &work,
                        const ProcessLimits &limits);
} // namespace nsfd
