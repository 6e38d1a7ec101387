#pragma once

#include <cstddef>

namespace nsfd
{
  /**
   * malloc(), and the pages of large blocks are asked to be large ones
   * (2 MiB): the first touch of a small page costs the kernel some 8 us, which
   * at a million unknowns is a quarter of the time of a short run. Only pages
   * that lie in the block as a whole, so that it takes no memory more than
   * before. operator new does the same.
   */
  void *allocate_large(std::size_t bytes);
} // namespace nsfd
