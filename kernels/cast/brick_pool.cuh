/// The pool of bricks on a device: masks and layers by slot, and the voxels of all of them one after another.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/cast/caster.h"
#include "kernels/cuda/memory.cuh"
#include "kernels/cuda/pinned.cuh"

namespace gigabake::kernels {

class BrickPool {
 public:
  BrickPool(DeviceHeap& heap, const PoolSizes& sizes);

  void show_in(CastScene& scene) const;

  /// As Caster's. Both return when it is done.
  void put(const std::vector<BrickPlace>& places, const std::vector<CastBrick>& bricks);
  void move(const std::vector<VoxelMove>& moves);

 private:
  template <class T, class Fill>
  void upload(DeviceArray<T>& device, std::size_t count, const Fill& fill);

  DeviceHeap& heap_;
  DeviceArray<CastMask> masks_;
  DeviceArray<CastLayer> layers_;
  DeviceArray<PackedVoxel> voxels_;
  DeviceArray<CastMask> new_masks_;
  DeviceArray<CastLayer> new_layers_;
  DeviceArray<PackedVoxel> new_voxels_, on_its_way_;
  DeviceArray<VoxelMove> moves_;
  PinnedBuffer pinned_;
};

}  // namespace gigabake::kernels
