#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace nsfd
{
  /** What is at @p place will be read soon. */
  inline void prefetch(const void *const place, const std::size_t bytes)
  {
    constexpr std::size_t line = 64, most = 16 * line;
    const auto *const begin = static_cast<const char *>(place);
    for (std::size_t b = 0; b < std::min(bytes, most); b += line)
      __builtin_prefetch(begin + b);
  }

  template <typename T>
  void prefetch(const std::vector<T> &list)
  {
    prefetch(list.data(), list.size() * sizeof(T));
  }
} // namespace nsfd
