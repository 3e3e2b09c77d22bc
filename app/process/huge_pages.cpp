// Large arrays on huge pages: a bake allocates and fills hundreds of megabytes a cell, and the kernel hands them out
// and clears them page by page. Where it offers huge pages on request (transparent_hugepage/enabled: madvise, the
// default of Debian and Ubuntu), asking makes a bake about a seventh faster; elsewhere nothing changes.
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#include <cstdlib>
#include <new>
#include <sys/mman.h>

namespace {

constexpr std::size_t huge_page_bytes = std::size_t(2) << 20;

}  // namespace

void* operator new(std::size_t size) {
  for (;;) {
    const bool is_large = size >= 2 * huge_page_bytes;
    void* data = is_large ? std::aligned_alloc(huge_page_bytes, (size + huge_page_bytes - 1) & ~(huge_page_bytes - 1))
                          : std::malloc(size == 0 ? 1 : size);
    if (data != nullptr) {
      if (is_large) madvise(data, size, MADV_HUGEPAGE);  // a wish: refused is as good as before
      return data;
    }
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* data) noexcept { std::free(data); }
void operator delete(void* data, std::size_t) noexcept { std::free(data); }
#endif
