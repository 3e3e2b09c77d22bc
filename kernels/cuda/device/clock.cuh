/// Times between marks in a stream.
#pragma once

#include <array>

#include "kernels/cuda/device/memory.cuh"

namespace gigabake::kernels {

class StreamClock {
 public:
  explicit StreamClock(cudaStream_t stream) : stream_(stream) {
    for (cudaEvent_t& e : events_) check_cuda(cudaEventCreate(&e), "cudaEventCreate");
  }
  ~StreamClock() {
    for (cudaEvent_t e : events_) cudaEventDestroy(e);
  }
  StreamClock(const StreamClock&) = delete;
  StreamClock& operator=(const StreamClock&) = delete;

  /// Records mark i (0 … 6) in the stream.
  void mark(int i) { check_cuda(cudaEventRecord(events_[std::size_t(i)], stream_), "cudaEventRecord"); }
  /// Returns the seconds between two marks. The stream must have passed both marks.
  double between(int i, int j) const {
    float ms = 0;
    check_cuda(cudaEventElapsedTime(&ms, events_[std::size_t(i)], events_[std::size_t(j)]), "cudaEventElapsedTime");
    return ms * 1e-3;
  }

 private:
  cudaStream_t stream_;
  std::array<cudaEvent_t, 7> events_{};
};

}  // namespace gigabake::kernels
