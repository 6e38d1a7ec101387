#include "large_pages.h"

#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <new>

namespace nsfd
{
  namespace
  {
    constexpr std::size_t large_page = std::size_t(1) << 21;
  } // namespace

  void *allocate_large(const std::size_t bytes)
  {
    void *const block = std::malloc(bytes);
    if (block && bytes >= 2 * large_page) {
      const auto first = reinterpret_cast<std::uintptr_t>(block),
                 begin = (first + large_page - 1) / large_page * large_page,
                 end = (first + bytes) / large_page * large_page;
      // a wish: without such pages all goes on as it is
      (void)madvise(reinterpret_cast<void *>(begin), end - begin,
                    MADV_HUGEPAGE);
    }
    return block;
  }
} // namespace nsfd

// what libraries allocate goes this way, too
void *operator new(const std::size_t bytes)
{
  for (;;) {
    if (void *const block = nsfd::allocate_large(bytes > 0 ? bytes : 1))
      return block;
    const std::new_handler handler = std::get_new_handler();
    if (!handler)
      throw std::bad_alloc();
    handler();
  }
}

void operator delete(void *const block) noexcept { std::free(block); }
void operator delete(void *const block, std::size_t) noexcept
{
  std::free(block);
}
