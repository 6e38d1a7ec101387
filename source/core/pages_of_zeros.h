#pragma once

#include <cstddef>
#include <type_traits>
#include <vector>

namespace nsfd
{
  void release_pages_of_zeros(void *data, std::size_t bytes);

  /**
   * Gives the memory of what has been freed back to the system. The heap keeps
   * it else for what comes next, in holes that are seldom of the right size:
   * after set-ups, whose lists are not those of steps.
   */
  void release_freed_memory();

  /**
   * Gives the memory of whole pages of zeros back to the system. They read as
   * before, and get memory again as soon as something is written to them: for
   * long lists of which few entries ever change. Nothing is done where the
   * system has no such pages, or for lists of less than some pages. A zero is
   * one of all bits: -0 keeps its memory.
   */
  template <typename T>
  void release_pages_of_zeros(std::vector<T> &values)
  {
    static_assert(std::is_trivially_copyable_v<T>);
    release_pages_of_zeros(values.data(), values.size() * sizeof(T));
  }
} // namespace nsfd
