/// Bytes on their way to a device, in a stream's order.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <cuda_runtime.h>
#include <vector>

#include "kernels/cuda/memory.cuh"
#include "kernels/cuda/pinned.cuh"

namespace gigabake::kernels {

/// Page-locked rooms by turns, so that one is filled while another is copied: nobody waits for a copy that was just
/// started.
class Delivery {
 public:
  explicit Delivery(DeviceHeap& heap);
  ~Delivery();
  Delivery(const Delivery&) = delete;
  Delivery& operator=(const Delivery&) = delete;

  /// Room to put bytes in, until send(). Waits where the device still reads what was sent the last time but one.
  /// Errors  CudaFailure, DeviceFull; so send().
  std::byte* room(std::size_t bytes);
  /// Starts the copy of what was put there. The answer is where the bytes are for what is launched before room() was
  /// called twice again.
  const std::byte* send();

  /// Both, for values that stand in a vector.
  template <class T>
  const T* send(const std::vector<T>& values) {
    const std::size_t bytes = values.size() * sizeof(T);
    std::memcpy(room(bytes), values.data(), bytes);
    return reinterpret_cast<const T*>(send());
  }

 private:
  struct Part {
    PinnedBuffer host;
    DeviceArray<std::byte> device;
    cudaEvent_t copied = nullptr;
  };

  DeviceHeap& heap_;
  std::array<Part, 2> parts_;
  std::size_t turn_ = 0, bytes_ = 0;
};

}  // namespace gigabake::kernels
