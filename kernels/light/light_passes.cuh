/// Lighting of a tile's pixels on a device. Separate kernels find the surfaces that the rays hit, list and cast rays to
/// the sun and the sky, and reuse shadow samples. A shader then lights the surfaces.
#pragma once

#include <memory>

#include "kernels/cuda/device/memory.cuh"
#include "kernels/light/shader.h"
#include "kernels/light/shadow_reuse.h"
#include "kernels/marching/ray_rounds.cuh"

namespace gigabake::kernels {

class LightPasses {
 public:
  LightPasses(DeviceHeap& heap, cudaStream_t stream) : heap_(heap), stream_(stream), count_(heap, 1) {}

  /// Starts a tile and discards the light of the previous tile.
  void start(const CastLighting& lighting, std::shared_ptr<const SurfaceShader> shader, std::size_t pixels);

  /// Casts rays to the light, like Caster::cast_light(). Adds the number of pixels with waiting rays to
  /// pass.unfinished.
  void cast(const RayPass& pass, std::size_t begin, std::size_t end);

  /// Reuses shadow samples, like Caster::reuse_shadow_samples().
  void share(const CastTile& tile);

  /// Lights the tile's finished rays and returns the lit copies, which are valid until the next call.
  const CastRay* lit(const CastRay* rays, const CastCamera& camera, const CastTile& tile);

 private:
  void cast_rays(const RayPass& pass, LightRay which, std::size_t begin, std::size_t end);

  DeviceHeap& heap_;
  cudaStream_t stream_;
  CastLighting lighting_;
  std::shared_ptr<const SurfaceShader> shader_;
  DeviceArray<PixelLight> lights_;
  DeviceArray<CastRay> lit_;
  DeviceArray<std::uint32_t> list_, count_;  ///< the pixels that cast a ray, and their number
};

}  // namespace gigabake::kernels
