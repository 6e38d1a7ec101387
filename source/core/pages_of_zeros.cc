#include "pages_of_zeros.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>

namespace nsfd
{
  void release_freed_memory() { malloc_trim(0); }

  /**
   * Pages of the heap are private and have no file behind them: those that
   * are given back are pages of zeros when they are read.
   */
  void release_pages_of_zeros(void *const block, const std::size_t n)
  {
    auto *const data = static_cast<unsigned char *>(block);
    static const auto page = std::size_t(sysconf(_SC_PAGESIZE));
    const auto address = reinterpret_cast<std::uintptr_t>(data);
    const std::size_t first = (page - address % page) % page;
    const auto is_zero = [&](const std::size_t begin) {
      return std::all_of(data + begin, data + begin + page,
                         [](const unsigned char byte) { return byte == 0; });
    };
    for (std::size_t begin = first; begin + page <= n;) {
      std::size_t end = begin;
      while (end + page <= n && is_zero(end))
        end += page;
      if (end > begin) {
        // one number written must not bring back a large page
        (void)madvise(data + begin, end - begin, MADV_NOHUGEPAGE);
        (void)madvise(data + begin, end - begin, MADV_DONTNEED);
      }
      begin = end + page;
    }
  }
} // namespace nsfd
