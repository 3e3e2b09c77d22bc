/// Upload of bytes to a device in stream order.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <cuda_runtime.h>
#include <vector>

#include "kernels/cuda/device/memory.cuh"
#include "kernels/cuda/device/pinned.cuh"
#include "kernels/cuda/device/stream.cuh"

namespace gigabake::kernels {

/// Two page-locked buffers that are used alternately. The host fills one buffer while the other is copied, so that the
/// host rarely waits.
class UploadRing {
 public:
  explicit UploadRing(DeviceHeap& heap) : heap_(heap) {}
  ~UploadRing();
  UploadRing(const UploadRing&) = delete;
  UploadRing& operator=(const UploadRing&) = delete;

  /// Returns a host buffer to fill before send(). Waits if the device is still copying from that buffer.
  /// Errors  CudaFailure, DeviceFull.
  std::byte* reserve(std::size_t bytes);
  /// Starts the copy of the buffer. Returns the device pointer. It is valid for kernels that are launched before the
  /// second next call of reserve().
  /// Errors  CudaFailure.
  const std::byte* send();

  /// Uploads a vector with reserve() and send().
  template <class T>
  const T* send(const std::vector<T>& values) {
    const std::size_t bytes = values.size() * sizeof(T);
    std::memcpy(reserve(bytes), values.data(), bytes);
    return reinterpret_cast<const T*>(send());
  }

 private:
  struct Part {
    PinnedBuffer host;
    DeviceArray<std::byte> device;
    Event copied;
  };

  DeviceHeap& heap_;
  std::array<Part, 2> parts_;
  std::size_t turn_ = 0, bytes_ = 0;
};

}  // namespace gigabake::kernels
