/// Transfer of arrays from a device to the host.
#pragma once

#include <cstddef>
#include <cuda_runtime.h>
#include <deque>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/cuda/device/pinned.cuh"
#include "kernels/cuda/device/stream.cuh"

namespace gigabake::kernels {

/// Download in pieces through page-locked memory. Threads copy a piece to its destination while later pieces are
/// transferred.
class DownloadRing {
 public:
  struct Part {
    void* host;
    const void* device;
    std::size_t bytes;
  };

  /// Borrows the pool.
  DownloadRing(cudaStream_t stream, const ThreadPool& pool) : stream_(stream), pool_(pool) {}
  DownloadRing(const DownloadRing&) = delete;
  DownloadRing& operator=(const DownloadRing&) = delete;

  /// Copies the arrays and returns when all of them are complete on the host.
  /// Errors  CudaFailure.
  void bring(std::span<const Part> parts);

 private:
  struct Piece {
    std::byte *host, *arrived;
    const std::byte* device;
    std::size_t bytes;
  };

  std::vector<Piece> pieces_of(std::span<const Part> parts);
  cudaEvent_t arrival_of(std::size_t piece);

  cudaStream_t stream_;
  const ThreadPool& pool_;
  PinnedBuffer room_;
  std::deque<Event> arrivals_;  ///< [piece]
};

}  // namespace gigabake::kernels
