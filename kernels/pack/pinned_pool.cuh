/// Page-locked buffers that are reused, because page-locking takes longer than filling a buffer.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include "kernels/cuda/device/pinned.cuh"

namespace gigabake::kernels {

/// Returns a capacity of at least `bytes` in steps of 25 %, so that cells of similar size do not enlarge a buffer
/// repeatedly.
inline std::size_t rounded_capacity(std::size_t bytes) {
  std::size_t capacity = std::size_t(8) << 20;
  while (capacity < bytes) capacity += capacity / 4;
  return capacity;
}

/// A pool with as many buffers as were in use at the same time. One thread calls take(); any thread may release a
/// buffer.
class PinnedPool {
 public:
  /// Returns an unused buffer of at least `bytes` bytes. A buffer that is new or grows gets half as much again as the
  /// largest request so far: while pages are locked, the driver serves no other thread.
  std::shared_ptr<PinnedBuffer> take(std::size_t bytes) {
    max_capacity_ = std::max(max_capacity_, rounded_capacity(bytes + bytes / 2));
    std::shared_ptr<PinnedBuffer> found = unused(bytes);
    std::atomic_thread_fence(std::memory_order_acquire);  // orders the reuse after the reads of the previous user
    if (found->capacity() < bytes) found->reserve(max_capacity_);
    return found;
  }

 private:
  /// Returns an unused buffer that suffices, if possible.
  std::shared_ptr<PinnedBuffer> unused(std::size_t bytes) {
    const std::shared_ptr<PinnedBuffer>* found = nullptr;
    for (const std::shared_ptr<PinnedBuffer>& buffer : buffers_)
      if (buffer.use_count() == 1 && (found == nullptr || (*found)->capacity() < bytes)) found = &buffer;
    if (found != nullptr) return *found;
    return buffers_.emplace_back(std::make_shared<PinnedBuffer>());
  }

  std::vector<std::shared_ptr<PinnedBuffer>> buffers_;
  std::size_t max_capacity_ = 0;
};

}  // namespace gigabake::kernels
