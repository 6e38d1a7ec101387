#pragma once

#include "lock_process.h"

#include <functional>
#include <string>

namespace nsfd
{
  /**
   * Do @p work in a copy of this process that has @p limits and can write
   * nothing: for libraries that a damaged file can crash. Exceptions of the
   * work count as its end: whoever does it again meets them. Returns what
   * ended the copy before, "signal 11, Segmentation fault", "more than 20 s",
   * "more than 4.0 GiB of memory", or an empty text.
   * Errors raised: std::system_error where no process can be started.
   */
  std::string try_in_a_copy(const std::function<void()> &work,
                            const ProcessLimits &limits);
} // namespace nsfd
