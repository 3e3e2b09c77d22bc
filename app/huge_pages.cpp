// The operator new of the programs. It requests huge pages for large arrays, because a page fault costs more than the
// work on 4 KiB (decision 607). Libraries of gigabake leave the operator to the program that uses them.
#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <sys/mman.h>

namespace {

constexpr std::size_t huge_page_bytes = std::size_t(2) << 20;

/// Returns memory like malloc(). A block of at least a huge page begins at a huge page, and requests as many as it
/// contains. A kernel without huge pages ignores the request.
void* allocate(std::size_t bytes) {
  if (bytes < huge_page_bytes) return std::malloc(std::max<std::size_t>(bytes, 1));
  void* block = nullptr;
  if (::posix_memalign(&block, huge_page_bytes, bytes) != 0) return nullptr;
  const int error_before = errno;
  ::madvise(block, bytes / huge_page_bytes * huge_page_bytes, MADV_HUGEPAGE);
  errno = error_before;
  return block;
}

}  // namespace

void* operator new(std::size_t bytes) {
  for (;;) {
    if (void* block = allocate(bytes)) return block;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }
