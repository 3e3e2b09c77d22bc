/// The light of a tile's pixels on a device: a kernel that finds what the tile's rays met, one that lists the pixels
/// that cast a ray to the sun or to the sky and one that casts these, one by which pixels share their light, and a
/// shader that lights what was met. None of them is a kernel of the tile's own rays.
#pragma once

#include <memory>

#include "kernels/cast/light_sharing.h"
#include "kernels/cast/ray_rounds.cuh"
#include "kernels/cast/shader.h"
#include "kernels/cuda/memory.cuh"

namespace gigabake::kernels {

class LightPasses {
 public:
  LightPasses(DeviceHeap& heap, cudaStream_t stream) : heap_(heap), stream_(stream), count_(heap, 1) {}

  /// Forgets the light of the tile before.
  void start(const CastLighting& lighting, std::shared_ptr<const SurfaceShader> shader, std::size_t pixels);

  /// As Caster::cast_light(). pass.unfinished: adds for how many pixels rays wait.
  void cast(const RayPass& pass, std::size_t begin, std::size_t end);

  /// As Caster::share_light().
  void share(const CastTile& tile);

  /// The tile's finished rays in their light; valid until the next call.
  const CastRay* lit(const CastRay* rays, const CastCamera& camera, const CastTile& tile);

 private:
  void cast_rays(const RayPass& pass, LightRay which, std::size_t begin, std::size_t end);

  DeviceHeap& heap_;
  cudaStream_t stream_;
  CastLighting lighting_;
  std::shared_ptr<const SurfaceShader> shader_;
  DeviceArray<PixelLight> lights_;
  DeviceArray<CastRay> lit_;
  DeviceArray<std::uint32_t> list_, count_;  ///< pixels that cast a ray
};

}  // namespace gigabake::kernels
