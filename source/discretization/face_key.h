#pragma once

#include <deal.II/grid/cell_id.h>

#include <cstdint>
#include <string>

// Keys of faces that are the same on every rank.

namespace nsfd
{
  /** As CellId::to_string(), without a stream. */
  inline void add_cell_id(const dealii::CellId &id, std::string &text)
  {
    const auto children = id.get_child_indices();
    text += std::to_string(id.get_coarse_cell_id()) + '_' +
            std::to_string(children.size()) + ':';
    for (const auto child : children)
      text += std::to_string(unsigned(child));
  }

  inline std::uint64_t hash_of(const std::string &text)
  {
    std::uint64_t value = 1469598103934665603ull;
    for (const unsigned char c : text)
      value = (value ^ c) * 1099511628211ull;
    // spread: neighbouring cells differ in a few characters only
    value ^= value >> 31;
    value *= 0x9e3779b97f4a7c15ull;
    value ^= value >> 29;
    return value;
  }
} // namespace nsfd
