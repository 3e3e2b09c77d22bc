/// A pass of rays on a device, in rounds: rays walk until they meet a sheet; those that did are listed and look at it;
/// those that it did not end are listed and walk on. So a warp has lanes with the same to do, however differently
/// its pixels' rays went before, and each kernel is small: warps of a large one wait for their instructions.
#pragma once

#include <cstdint>

#include "kernels/cast/cast.h"
#include "kernels/cast/ray_list.cuh"
#include "kernels/cuda/memory.cuh"

namespace gigabake::kernels {

/// Where a pass is, as its kernels take it.
struct RayPass {
  CastScene scene;
  CastCamera camera;
  CastTile tile;
  CastRay* rays;
  bool patient;
  bool starts;  ///< the rays are not started yet
  unsigned long long* unfinished;
};

/// Lists of a pass's rounds, for a tile of `capacity` rays.
class RayRounds {
 public:
  RayRounds(DeviceHeap& heap, cudaStream_t stream) : heap_(heap), stream_(stream), counts_(heap, 2 * rounds) {}

  /// Goes on with rays [begin, end) until each is finished or waits. pass.unfinished: adds how many wait.
  void cast(const RayPass& pass, std::size_t begin, std::size_t end);

 private:
  /// Few rays meet more sheets; what is left of these takes no more rounds.
  static constexpr std::size_t rounds = 2;

  DeviceHeap& heap_;
  cudaStream_t stream_;
  DeviceArray<std::uint32_t> counts_, met_, going_on_;
};

}  // namespace gigabake::kernels
