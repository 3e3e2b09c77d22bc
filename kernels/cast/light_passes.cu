#include <utility>

#include "kernels/cast/light_passes.cuh"
#include "kernels/cast/tile_grid.cuh"

namespace gigabake::kernels {
namespace {

/// Blocks of a multiprocessor, as of the kernel that casts what is left of a tile's rays.
constexpr unsigned min_lighting = 3;

__global__ void forget_light(PixelLight* lights, std::size_t pixels) {
  const std::size_t i = std::size_t(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i < pixels) lights[i] = PixelLight();
}

/// The pixel of this thread and its index in the tile; false where it is none of [begin, end).
__device__ bool pixel_in_range(const CastTile& tile, std::size_t begin, std::size_t end, int& x, int& y,
                               std::size_t& i) {
  const bool is_in = pixel_of_thread(tile, x, y);
  i = std::size_t(y) * std::size_t(tile.width) + std::size_t(x);
  return is_in && i >= begin && i < end;
}

__global__ void __launch_bounds__(tile_threads, min_lighting)
    find_surfaces(RayPass pass, CastLighting lighting, PixelLight* lights, std::size_t begin, std::size_t end) {
  int x, y;
  std::size_t i;
  if (!pixel_in_range(pass.tile, begin, end, x, y, i)) return;
  PixelLight light = lights[i];
  const CastLine line = line_of_sight(pass.scene, pass.camera, pass.tile.x + x, pass.tile.y + y);
  find_surface_once(pass.scene, lighting, line, pass.patient, pass.rays[i], light);
  lights[i] = light;
  if (lighting.part == CastLightPart::unhidden && light.done != PixelLight::all) atomicAdd(pass.unfinished, 1ull);
}

/// Ray r of each pixel; all lanes of a warp cast. After the last one: how many pixels wait.
__global__ void __launch_bounds__(tile_threads, min_lighting)
    cast_light_rays(RayPass pass, CastLighting lighting, PixelLight* lights, int r, std::size_t begin,
                    std::size_t end) {
  int x, y;
  std::size_t i;
  const bool is_in = pixel_in_range(pass.tile, begin, end, x, y, i);
  PixelLight light;
  if (is_in) light = lights[i];
  cast_to_light(pass.scene, pass.camera, lighting, pass.tile.x + x, pass.tile.y + y, r, pass.patient, is_in, light);
  if (!is_in) return;
  lights[i] = light;
  if (r + 1 == light_rays && light.done != PixelLight::all) atomicAdd(pass.unfinished, 1ull);
}

}  // namespace

void LightPasses::start(const CastLighting& lighting, std::shared_ptr<const SurfaceShader> shader, std::size_t pixels) {
  lighting_ = lighting;
  shader_ = shader ? std::move(shader) : lit_shader({lighting.light, lighting.part});
  if (lights_.size() < pixels) {
    lights_ = DeviceArray<PixelLight>(heap_, pixels);
    lit_ = DeviceArray<CastRay>(heap_, pixels);
  }
  forget_light<<<grid_of(pixels, tile_threads), tile_threads, 0, stream_>>>(lights_.data(), pixels);
  check_launch("forget_light");
}

void LightPasses::cast(const RayPass& pass, std::size_t begin, std::size_t end) {
  const unsigned grid = grid_of_tile(pass.tile);
  find_surfaces<<<grid, tile_threads, 0, stream_>>>(pass, lighting_, lights_.data(), begin, end);
  check_launch("find_surfaces");
  for (int r = 0; lighting_.part != CastLightPart::unhidden && r < light_rays; ++r) {
    cast_light_rays<<<grid, tile_threads, 0, stream_>>>(pass, lighting_, lights_.data(), r, begin, end);
    check_launch("cast_light_rays");
  }
}

const CastRay* LightPasses::lit(const CastRay* rays, const CastCamera& camera, const CastTile& tile) {
  const ShadedTile shaded{rays, lights_.data(), tile, lighting_, {camera.eye[0], camera.eye[1], camera.eye[2]}};
  shader_->on_device(shaded, lit_.data(), stream_);
  return lit_.data();
}

}  // namespace gigabake::kernels
