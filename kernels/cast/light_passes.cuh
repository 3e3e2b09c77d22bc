/// The light of a tile's pixels on a device: a kernel that finds what the tile's rays met, one that casts the rays to
/// the light, once for each of a pixel's, and a shader that lights what was met. None of them is a kernel of the tile's
/// own rays.
#pragma once

#include <memory>

#include "kernels/cast/light_rays.h"
#include "kernels/cast/ray_rounds.cuh"
#include "kernels/cast/shader.h"
#include "kernels/cuda/memory.cuh"

namespace gigabake::kernels {

class LightPasses {
 public:
  LightPasses(DeviceHeap& heap, cudaStream_t stream) : heap_(heap), stream_(stream) {}

  /// Forgets the light of the tile before.
  void start(const CastLighting& lighting, std::shared_ptr<const SurfaceShader> shader, std::size_t pixels);

  /// As Caster::cast_light(). pass.unfinished: adds for how many pixels rays wait.
  void cast(const RayPass& pass, std::size_t begin, std::size_t end);

  /// The tile's finished rays in their light; valid until the next call.
  const CastRay* lit(const CastRay* rays, const CastCamera& camera, const CastTile& tile);

 private:
  DeviceHeap& heap_;
  cudaStream_t stream_;
  CastLighting lighting_;
  std::shared_ptr<const SurfaceShader> shader_;
  DeviceArray<PixelLight> lights_;
  DeviceArray<CastRay> lit_;
};

}  // namespace gigabake::kernels
