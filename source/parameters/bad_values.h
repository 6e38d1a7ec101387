#pragma once

#include <string>
#include <vector>

namespace nsfd
{
  /**
   * Formulas of the input that gave no finite number since the last call, with
   * the entry, the place and the time of the first such value of each:
   * "Boundary: left/velocity x = 1 / x is infinite at (0, 1, 0), t = 0". Of
   * this rank: places differ between ranks, and so do these lists.
   */
  std::vector<std::string> take_bad_values();

  /** True if take_bad_values() has something to tell. */
  bool has_bad_values();
} // namespace nsfd
