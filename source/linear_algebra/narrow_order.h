#pragma once

#include <vector>

namespace nsfd
{
  /**
   * An order of the places of a graph in which neighbours are near each other
   * [Cuthill and McKee 1969], part by part: @p neighbors of place i, without
   * itself, both ways. Entry k of the result is the place that comes k-th.
   */
  std::vector<int> narrow_order(const std::vector<std::vector<int>> &neighbors);
} // namespace nsfd
