/// The pool of bricks on a device: masks and layers by slot, and the voxels of all of them one after another.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/cast/caster.h"
#include "kernels/cuda/delivery.cuh"
#include "kernels/cuda/memory.cuh"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// The pool of voxels, where it is written.
struct VoxelArrays {
  PackedSurface* surfaces;
  std::uint32_t* radiances;
};

class BrickPool {
 public:
  /// Borrows heap, delivery and pool.
  BrickPool(DeviceHeap& heap, Delivery& delivery, const ThreadPool& pool, const PoolSizes& sizes);

  void show_in(CastScene& scene) const;

  /// As Caster's. Both return when what they were given may change again; the stream does the rest in its order.
  void put(const std::vector<BrickPlace>& places, const std::vector<CastBrick>& bricks);
  void move(const std::vector<VoxelMove>& moves);

 private:
  VoxelArrays voxels() { return {surfaces_.data(), radiances_.data()}; }
  template <class T>
  void copy_on_device(const T* from, std::size_t count, T* to);

  DeviceHeap& heap_;
  Delivery& delivery_;
  const ThreadPool& pool_;
  DeviceArray<CastMask> masks_;
  DeviceArray<CastLayer> layers_;
  DeviceArray<PackedSurface> surfaces_, surfaces_on_their_way_;
  DeviceArray<std::uint32_t> radiances_, radiances_on_their_way_;
};

}  // namespace gigabake::kernels
