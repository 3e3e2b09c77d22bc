/// Page-locked buffers that are reused, because page-locking takes longer than filling a buffer.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include "kernels/cuda/device/pinned.cuh"

namespace gigabake::kernels {

/// A pool with as many buffers as were in use at the same time. One thread calls take(); any thread may release a
/// buffer.
class PinnedPool {
 public:
  /// Returns an unused buffer. Its size is arbitrary; PinnedBuffer::reserve() enlarges it.
  std::shared_ptr<PinnedBuffer> take() {
    for (const std::shared_ptr<PinnedBuffer>& buffer : buffers_)
      if (buffer.use_count() == 1) {
        std::atomic_thread_fence(std::memory_order_acquire);  // orders the reuse after the reads of the previous user
        return buffer;
      }
    buffers_.push_back(std::make_shared<PinnedBuffer>());
    return buffers_.back();
  }

 private:
  std::vector<std::shared_ptr<PinnedBuffer>> buffers_;
};

/// Returns a capacity of at least `bytes` in steps of 25 %, so that cells of similar size do not enlarge a buffer
/// repeatedly.
inline std::size_t rounded_capacity(std::size_t bytes) {
  std::size_t capacity = std::size_t(8) << 20;
  while (capacity < bytes) capacity += capacity / 4;
  return capacity;
}

}  // namespace gigabake::kernels
