/// Page-locked buffers that are used again: to lock one takes longer than to fill it.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include "kernels/cuda/pinned.cuh"

namespace gigabake::kernels {

/// As many buffers as are in use at a time. One thread asks; the last who holds a buffer, any thread, lets it go.
class PinnedPool {
 public:
  /// A buffer that nobody else holds, of any size. Errors  CudaFailure when it reserves.
  std::shared_ptr<PinnedBuffer> take() {
    for (const std::shared_ptr<PinnedBuffer>& buffer : buffers_)
      if (buffer.use_count() == 1) {
        std::atomic_thread_fence(std::memory_order_acquire);  // after what its last holder read
        return buffer;
      }
    buffers_.push_back(std::make_shared<PinnedBuffer>());
    return buffers_.back();
  }

 private:
  std::vector<std::shared_ptr<PinnedBuffer>> buffers_;
};

/// Rounded up, so that cells of about the same size do not make a buffer grow again and again.
inline std::size_t roomy(std::size_t bytes) {
  std::size_t room = std::size_t(8) << 20;
  while (room < bytes) room += room / 4;
  return room;
}

}  // namespace gigabake::kernels
