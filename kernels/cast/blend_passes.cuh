/// The second rays of pixels between two levels, on a device (kernels/cast/level_blend.h). They are cast by the kernels
/// that cast the first ones, as a tile of rays of their own.
#pragma once

#include "kernels/cast/level_blend.h"
#include "kernels/cast/ray_rounds.cuh"
#include "kernels/cuda/memory.cuh"

namespace gigabake::kernels {

class BlendPasses {
 public:
  BlendPasses(DeviceHeap& heap, cudaStream_t stream) : heap_(heap), stream_(stream) {}

  /// Forgets those of the tile before. pass: of the first rays, which are finished.
  void start(const RayPass& pass);

  /// As Caster::cast_blend(). pass: of the first rays; pass.unfinished: adds how many of the second ones wait.
  void cast(RayRounds& rounds, const RayPass& pass, std::size_t begin, std::size_t end);

  /// Puts what both show into the first ones.
  void blend(const RayPass& pass);

 private:
  DeviceHeap& heap_;
  cudaStream_t stream_;
  DeviceArray<CastRay> coarser_;
};

}  // namespace gigabake::kernels
