/// Device memory with its books kept: stream-ordered arrays from one pool, what is live and what was the most.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cuda_runtime.h>
#include <utility>

#include "kernels/cuda/pinned.cuh"
#include "lattice/cuda_failure.h"

namespace gigabake::kernels {

/// Errors  CudaFailure, naming the call.
void check_cuda(cudaError_t code, const char* call);

/// Device bytes of all of a baker's heaps.
class DeviceBooks {
 public:
  void add(std::int64_t bytes) {
    const std::int64_t now = live_ += bytes;
    std::int64_t peak = peak_;
    while (peak < now && !peak_.compare_exchange_weak(peak, now)) {
    }
  }
  std::uint64_t peak_bytes() const { return std::uint64_t(peak_.load()); }
  void restart_peak() { peak_ = live_.load(); }

 private:
  std::atomic<std::int64_t> live_{0}, peak_{0};
};

/// The allocations of one stream. What one stream makes and another reads is freed once the host has waited for the
/// reader.
class DeviceHeap {
 public:
  DeviceHeap(cudaStream_t stream, DeviceBooks& books) : stream_(stream), books_(books) {}

  /// Errors  DeviceFull.
  void* take(std::size_t bytes);
  void give(void* data, std::size_t bytes) noexcept;
  /// Live bytes that take() does not go beyond; what is live already may be more. 0: whatever the device has.
  void limit_to(std::uint64_t bytes) { limit_ = bytes; }

  /// Brings to the host what kernels found, once they are done: few bytes, which the host must know to go on. By way of
  /// page-locked memory, or the driver would make a copy of its own. what: for the line of an error.
  void bring(void* host, const void* device, std::size_t bytes, const char* what);

  std::uint64_t live() const { return live_; }
  cudaStream_t stream() const { return stream_; }

 private:
  cudaStream_t stream_;
  DeviceBooks& books_;
  std::atomic<std::uint64_t> live_{0};  ///< arrays may be freed by another thread than the one that bakes
  std::uint64_t limit_ = 0;
  PinnedBuffer arrived_;
};

/// An array of the device, freed in stream order. Not initialised.
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

/// A scan's or selection's room, as cub asks for it.
using TemporaryStorage = DeviceArray<std::uint8_t>;

/// Runs step(temporary, bytes) of cub: first without room, to be told the bytes, then with it.
template <class Step>
void with_temporary(DeviceHeap& heap, const Step& step) {
  std::size_t bytes = 0;
  step(nullptr, bytes);
  const TemporaryStorage temporary(heap, bytes);
  step(static_cast<void*>(temporary.data()), bytes);
}

/// Blocks of `threads` that cover `items`; at least one, so that a launch is never empty.
inline unsigned grid_of(std::uint64_t items, unsigned threads) {
  return unsigned(items == 0 ? 1 : (items + threads - 1) / threads);
}

inline void check_launch(const char* kernel) { check_cuda(cudaGetLastError(), kernel); }

}  // namespace gigabake::kernels
