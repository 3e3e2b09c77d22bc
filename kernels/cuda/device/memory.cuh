/// Device memory: stream-ordered arrays of one pool, with counters of live and peak bytes.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cuda_runtime.h>
#include <utility>

#include "core/base/error.h"
#include "core/base/work_counts.h"
#include "kernels/cuda/device/pinned.cuh"

namespace gigabake::kernels {

/// Throws if `code` is an error.
/// Errors  CudaFailure, naming the call.
void check_cuda(cudaError_t code, const char* call);

/// Live and peak bytes of all heaps of a baker.
class DeviceMemoryStats {
 public:
  void add(std::int64_t bytes) {
    const std::int64_t now = live_ += bytes;
    std::int64_t peak = peak_;
    while (peak < now && !peak_.compare_exchange_weak(peak, now)) {
    }
  }
  std::uint64_t live_bytes() const { return std::uint64_t(live_.load()); }
  std::uint64_t peak_bytes() const { return std::uint64_t(peak_.load()); }
  void restart_peak() { peak_ = live_.load(); }

 private:
  std::atomic<std::int64_t> live_{0}, peak_{0};
};

/// Allocator of one stream. If another stream reads an array, the host must wait for that stream before it frees the
/// array.
class DeviceHeap {
 public:
  DeviceHeap(cudaStream_t stream, DeviceMemoryStats& memory_stats) : stream_(stream), memory_stats_(memory_stats) {}

  /// Allocates memory in stream order.
  /// Errors  DeviceFull, CudaFailure.
  void* take(std::size_t bytes);
  void give(void* data, std::size_t bytes) noexcept;
  /// Sets the max number of live bytes, beyond which take() throws DeviceFull. Bytes that are live already may exceed
  /// it. If it is 0, the device's memory is the only limit.
  void limit_to(std::uint64_t bytes) { limit_ = bytes; }
  /// Returns the number of bytes that can be allocated within the limit; the max number if there is no limit.
  std::uint64_t available() const {
    if (limit_ == 0) return ~std::uint64_t(0);
    return limit_ - std::min(limit_, live_.load());
  }

  /// Copies a few bytes to the host and waits for the copy and for the kernels before it. A page-locked buffer of the
  /// heap receives the bytes, so that the driver need not stage a copy to pageable memory. `what` names the step in an
  /// error's message.
  void bring(void* host, const void* device, std::size_t bytes, const char* what);

  std::uint64_t live() const { return live_; }
  cudaStream_t stream() const { return stream_; }

 private:
  cudaStream_t stream_;
  DeviceMemoryStats& memory_stats_;
  std::atomic<std::uint64_t> live_{0};  ///< atomic: a thread other than the baking thread may free arrays
  std::uint64_t limit_ = 0;
  PinnedBuffer arrived_;
};

/// Array on the device, freed in stream order. Its elements are not initialised.
template <class T>
class DeviceArray {
 public:
  DeviceArray() = default;
  DeviceArray(DeviceHeap& heap, std::size_t size)
      : heap_(&heap), data_(static_cast<T*>(heap.take(size * sizeof(T)))), size_(size) {}
  DeviceArray(DeviceArray&& o) noexcept { *this = std::move(o); }
  DeviceArray& operator=(DeviceArray&& o) noexcept {
    std::swap(heap_, o.heap_);
    std::swap(data_, o.data_);
    std::swap(size_, o.size_);
    return *this;
  }
  ~DeviceArray() {
    if (heap_ != nullptr) heap_->give(data_, size_ * sizeof(T));
  }

  T* data() const { return data_; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  std::size_t bytes() const { return size_ * sizeof(T); }

  void clear_to_zero() { check_cuda(cudaMemsetAsync(data_, 0, bytes(), heap_->stream()), "cudaMemsetAsync"); }

 private:
  DeviceHeap* heap_ = nullptr;
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Temporary storage of a cub scan or selection.
using TemporaryStorage = DeviceArray<std::uint8_t>;

/// Runs step(temporary, bytes) of cub twice: first with null to query the bytes, then with temporary storage.
template <class Step>
void with_temporary(DeviceHeap& heap, const Step& step) {
  std::size_t bytes = 0;
  step(nullptr, bytes);
  const TemporaryStorage temporary(heap, bytes);
  step(static_cast<void*>(temporary.data()), bytes);
}

/// Returns the number of blocks of `threads` threads that cover `items`; at least one, because CUDA rejects empty
/// launches.
inline unsigned grid_of(std::uint64_t items, unsigned threads) {
  return unsigned(items == 0 ? 1 : (items + threads - 1) / threads);
}

/// Checks and counts a launch. Call it after each launch.
inline void check_launch(const char* kernel) {
  count_work(WorkCounter::device_launches);
  check_cuda(cudaGetLastError(), kernel);
}

/// Copies in stream order, and counts the bytes. `what` names the step in an error's message.
void upload_async(void* device, const void* host, std::size_t bytes, cudaStream_t stream, const char* what);
void download_async(void* host, const void* device, std::size_t bytes, cudaStream_t stream, const char* what);
/// Returns a copy of `size` elements, in stream order.
template <class T>
DeviceArray<T> uploaded(DeviceHeap& heap, const T* host, std::size_t size) {
  DeviceArray<T> array(heap, size);
  if (size != 0) upload_async(array.data(), host, array.bytes(), heap.stream(), "cudaMemcpyAsync (upload)");
  return array;
}
/// Waits for the stream or event, and counts the synchronization.
void wait_for(cudaStream_t stream, const char* what);
void wait_for(cudaEvent_t event, const char* what);

}  // namespace gigabake::kernels
