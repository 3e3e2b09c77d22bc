/// The second rays of pixels between two levels, on a device (kernels/marching/level_blend.h). The kernels that cast
/// first rays also cast second rays, as a separate tile of rays.
#pragma once

#include "kernels/cuda/device/memory.cuh"
#include "kernels/marching/level_blend.h"
#include "kernels/marching/ray_rounds.cuh"

namespace gigabake::kernels {

class BlendPasses {
 public:
  BlendPasses(DeviceHeap& heap, cudaStream_t stream) : heap_(heap), stream_(stream) {}

  /// Starts second rays and discards the second rays of the previous tile. `pass` is the pass of the first rays, which
  /// must be finished.
  void start(const RayPass& pass);

  /// Casts second rays, like Caster::cast_blend(). `pass` is the pass of the first rays. Adds the number of waiting
  /// rays to pass.unfinished.
  void cast(RayRounds& rounds, const RayPass& pass, std::size_t begin, std::size_t end);

  /// Blends the second rays into the first rays.
  void blend(const RayPass& pass);

 private:
  DeviceHeap& heap_;
  cudaStream_t stream_;
  DeviceArray<CastRay> coarser_;
};

}  // namespace gigabake::kernels
