/// Where bytes from a device arrive on the host.
#pragma once

#include <cstddef>

namespace gigabake::kernels {

/// Page-locked host memory, which a device writes to at the speed of its link. Grows, and is kept.
class PinnedBuffer {
 public:
  PinnedBuffer() = default;
  ~PinnedBuffer();
  PinnedBuffer(const PinnedBuffer&) = delete;
  PinnedBuffer& operator=(const PinnedBuffer&) = delete;

  /// Errors  CudaFailure.
  std::byte* reserve(std::size_t bytes);

 private:
  std::byte* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace gigabake::kernels
