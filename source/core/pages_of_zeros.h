#pragma once

#include <cstdint>
#include <vector>

namespace nsfd
{
  /**
   * Gives the memory of whole pages of zeros back to the system. They read as
   * before, and get memory again as soon as something is written to them: for
   * long lists of which few entries ever change. Nothing is done where the
   * system has no such pages, or for lists of less than some pages. A zero is
   * one of all bits: -0 keeps its memory.
   */
  void release_pages_of_zeros(std::vector<double> &values);
  void release_pages_of_zeros(std::vector<std::uint8_t> &values);
} // namespace nsfd
