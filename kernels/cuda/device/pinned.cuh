/// Page-locked host memory.
#pragma once

#include <cstddef>

namespace gigabake::kernels {

/// Buffer that a device copies to at the full speed of its link. Grows as required and never shrinks.
class PinnedBuffer {
 public:
  PinnedBuffer() = default;
  ~PinnedBuffer();
  PinnedBuffer(const PinnedBuffer&) = delete;
  PinnedBuffer& operator=(const PinnedBuffer&) = delete;

  /// Returns at least `bytes` bytes. Growing discards the contents.
  /// Errors  CudaFailure.
  std::byte* reserve(std::size_t bytes);
  std::size_t capacity() const { return bytes_; }

 private:
  std::byte* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace gigabake::kernels
