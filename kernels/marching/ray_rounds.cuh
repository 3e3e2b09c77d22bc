/// A pass of rays on a device, in waves. Rays are traversed until they hit a blended surface. Rays with a hit are
/// listed, and a second kernel composites their surfaces. Rays that continue are listed and traversed again. The lanes
/// of a warp therefore do the same work. Each kernel is small, because warps of a large kernel wait for instructions.
#pragma once

#include <cstdint>

#include "kernels/cuda/device/memory.cuh"
#include "kernels/marching/cast.h"
#include "kernels/marching/ray_list.cuh"

namespace gigabake::kernels {

/// The arguments of a pass's kernels.
struct RayPass {
  CastScene scene;
  CastCamera camera;
  CastTile tile;
  CastRay* rays;
  bool blocking;
  bool starts;  ///< the rays are not started yet
  unsigned long long* unfinished;
};

/// The ray lists of a pass's waves.
class RayRounds {
 public:
  RayRounds(DeviceHeap& heap, cudaStream_t stream) : heap_(heap), stream_(stream), counts_(heap, 2 * rounds) {}

  /// Continues rays [begin, end) until each is finished or waits. Adds the number of waiting rays to pass.unfinished.
  void cast(const RayPass& pass, std::size_t begin, std::size_t end);

 private:
  /// The number of waves. Few rays hit more than this many surfaces; one kernel finishes these rays.
  static constexpr std::size_t rounds = 2;

  template <RayType ray_type>
  void cast_as(const RayPass& pass, std::size_t begin, std::size_t end);

  DeviceHeap& heap_;
  cudaStream_t stream_;
  DeviceArray<std::uint32_t> counts_, met_, continuing_;
};

}  // namespace gigabake::kernels
