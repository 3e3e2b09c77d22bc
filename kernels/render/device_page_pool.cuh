/// A page pool in device memory.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/cuda/device/memory.cuh"
#include "kernels/cuda/device/upload_ring.cuh"
#include "kernels/render/page_pool.h"

namespace gigabake::kernels {

class DevicePagePool {
 public:
  /// Creates a pool. Borrows `heap`, `uploads` and `pool`. `tables` are tables in device memory.
  DevicePagePool(DeviceHeap& heap, UploadRing& uploads, const ThreadPool& pool, const PagePoolSize& size,
                 const Tables& tables);

  /// Copies pages in stream order. The caller may change them after the call.
  void put(const std::vector<PageUpload>& pages);

  StoredVoxels voxels() const;
  /// Returns PagePoolSize::shading with tables in device memory.
  const StoredVoxelShading& shading() const { return shading_; }

 private:
  void put_some(std::span<const PageUpload> pages, std::size_t words);

  DeviceHeap& heap_;
  UploadRing& uploads_;
  const ThreadPool& pool_;
  /// The columns of StoredVoxels in their order; columns that the pool does not have are empty.
  std::array<DeviceArray<std::uint32_t>, 4> columns_;
  DeviceArray<std::uint8_t> coverage_, class_colour_;
  StoredVoxelShading shading_;
};

}  // namespace gigabake::kernels
