#pragma once

namespace nsfd
{
  /** What the program ends with. */
  namespace exit_code
  {
    constexpr int done = 0, bad_input = 1, wrong_usage = 2, step_failed = 3,
                  stopped = 4, internal_error = 5,
                  differs = 6, ///< of `nsfd compare --tolerance`
        not_certified = 7;     ///< --strict: done, certificate not ok
  }
} // namespace nsfd
