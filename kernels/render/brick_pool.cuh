/// A pool of bricks on a device: one array of heads, indexed by slot, and one array with the parts of all bricks.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/cuda/device/memory.cuh"
#include "kernels/cuda/device/upload_ring.cuh"
#include "kernels/render/caster.h"
#include "kernels/render/device_page_pool.cuh"

namespace gigabake::kernels {

class BrickPool {
 public:
  /// Creates a pool. Borrows `heap`, `uploads` and `pool`.
  BrickPool(DeviceHeap& heap, UploadRing& uploads, const ThreadPool& pool, const PoolSizes& sizes);

  void show_in(CastScene& scene) const;

  /// Implements Caster::put_bricks() and move_voxels(). The caller may change the arguments after the call; the stream
  /// executes the copies in order.
  void put(const std::vector<BrickPlace>& places, const CastBricks& bricks, const DevicePagePool& pages);
  void move(const std::vector<VoxelMove>& moves);

 private:
  DeviceHeap& heap_;
  UploadRing& uploads_;
  const ThreadPool& pool_;
  DeviceArray<CastHead> heads_;
  DeviceArray<PackedVoxel> voxels_, move_buffer_;
};

}  // namespace gigabake::kernels
