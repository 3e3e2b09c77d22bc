#include <utility>

#include "kernels/light/light_passes.cuh"
#include "kernels/marching/tile_grid.cuh"

namespace gigabake::kernels {
namespace {

/// Blocks per multiprocessor, as for cast_listed() (kernels/marching/ray_rounds.cu).
constexpr unsigned min_lighting = 3;

__global__ void clear_light(PixelLight* lights, std::size_t pixels) {
  const std::size_t i = std::size_t(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i < pixels) lights[i] = PixelLight();
}

/// Computes this thread's pixel and its index in the tile. Returns false if the pixel is not in [begin, end).
__device__ bool pixel_in_range(const CastTile& tile, std::size_t begin, std::size_t end, int& x, int& y,
                               std::size_t& i) {
  const bool is_in = pixel_of_thread(tile, x, y);
  i = std::size_t(y) * std::size_t(tile.width) + std::size_t(x);
  return is_in && i >= begin && i < end;
}

__global__ void __launch_bounds__(tile_threads, min_lighting)
    find_surfaces(const __grid_constant__ RayPass pass, CastLighting lighting, PixelLight* lights, std::size_t begin,
                  std::size_t end) {
  int x, y;
  std::size_t i;
  if (!pixel_in_range(pass.tile, begin, end, x, y, i) || lights[i].has(light_rays)) return;
  PixelLight light = lights[i];
  const int px = pass.tile.x + x, py = pass.tile.y + y;
  const CastLine line = line_of_sight(pass.scene, pass.camera, px, py);
  find_surface_once(pass.scene, lighting, line, pass.blocking, pass.rays[i], px, py, light);
  lights[i] = light;
}

/// Lists pixels whose surface is known and whose ray `which` is unfinished. All lanes of a warp call append().
__global__ void list_light_rays(CastTile tile, const PixelLight* lights, LightRay which, std::size_t begin,
                                std::size_t end, RayList list) {
  int x, y;
  std::size_t i;
  const bool is_in = pixel_in_range(tile, begin, end, x, y, i);
  append(is_in && lights[i].has(light_rays) && !lights[i].has(int(which)), std::uint32_t(i), list);
}

/// Casts ray `which` of each listed pixel. All lanes of a warp participate.
__global__ void __launch_bounds__(tile_threads, min_lighting)
    cast_light_rays(const __grid_constant__ RayPass pass, CastLighting lighting, PixelLight* lights, LightRay which,
                    RayList list) {
  const std::uint32_t count = *list.count, first = blockIdx.x * blockDim.x;
  if (first >= count) return;
  const bool is_in = first + threadIdx.x < count;
  const std::uint32_t i = is_in ? list.rays[first + threadIdx.x] : 0, width = std::uint32_t(pass.tile.width);
  PixelLight light;
  if (is_in) light = lights[i];
  cast_to_light(pass.scene, pass.camera, lighting, pass.tile.x + int(i % width), pass.tile.y + int(i / width), which,
                pass.blocking, is_in, light);
  if (is_in) lights[i] = light;
}

__global__ void count_unfinished(CastTile tile, const PixelLight* lights, std::size_t begin, std::size_t end,
                                 unsigned long long* unfinished) {
  int x, y;
  std::size_t i;
  if (pixel_in_range(tile, begin, end, x, y, i) && lights[i].done != PixelLight::all) atomicAdd(unfinished, 1ull);
}

__global__ void reuse_shadow_samples(CastTile tile, CastLighting lighting, PixelLight* lights) {
  int x, y;
  if (!pixel_of_thread(tile, x, y)) return;
  reuse_shadow_samples({lights, tile}, lighting, x, y,
                       lights[std::size_t(y) * std::size_t(tile.width) + std::size_t(x)]);
}

}  // namespace

void LightPasses::start(const CastLighting& lighting, std::shared_ptr<const SurfaceShader> shader, std::size_t pixels) {
  lighting_ = lighting;
  shader_ = shader ? std::move(shader) : lit_shader({lighting.light, lighting.part});
  if (lights_.size() < pixels) {
    lights_ = DeviceArray<PixelLight>(heap_, pixels);
    lit_ = DeviceArray<CastRay>(heap_, pixels);
    list_ = DeviceArray<std::uint32_t>(heap_, pixels);
  }
  clear_light<<<grid_of(pixels, tile_threads), tile_threads, 0, stream_>>>(lights_.data(), pixels);
  check_launch("forget_light");
}

void LightPasses::cast(const RayPass& pass, std::size_t begin, std::size_t end) {
  const unsigned grid = grid_of_tile(pass.tile);
  find_surfaces<<<grid, tile_threads, 0, stream_>>>(pass, lighting_, lights_.data(), begin, end);
  check_launch("find_surfaces");
  for (int r = 0; lighting_.part != CastLightPart::unshadowed && r < light_rays; ++r)
    cast_rays(pass, LightRay(r), begin, end);
  count_unfinished<<<grid, tile_threads, 0, stream_>>>(pass.tile, lights_.data(), begin, end, pass.unfinished);
  check_launch("count_unfinished");
}

void LightPasses::cast_rays(const RayPass& pass, LightRay which, std::size_t begin, std::size_t end) {
  count_.clear_to_zero();
  const RayList list{list_.data(), count_.data()};
  list_light_rays<<<grid_of_tile(pass.tile), tile_threads, 0, stream_>>>(pass.tile, lights_.data(), which, begin, end,
                                                                         list);
  check_launch("list_light_rays");
  const std::size_t pixels = std::size_t(pass.tile.width) * std::size_t(pass.tile.height);
  cast_light_rays<<<grid_of(pixels, tile_threads), tile_threads, 0, stream_>>>(pass, lighting_, lights_.data(), which,
                                                                               list);
  check_launch("cast_light_rays");
}

void LightPasses::share(const CastTile& tile) {
  reuse_shadow_samples<<<grid_of_tile(tile), tile_threads, 0, stream_>>>(tile, lighting_, lights_.data());
  check_launch("share_lights");
}

const CastRay* LightPasses::lit(const CastRay* rays, const CastCamera& camera, const CastTile& tile) {
  const ShadedTile shaded{rays, lights_.data(), tile, lighting_, camera.eye};
  shader_->on_device(shaded, lit_.data(), stream_);
  return lit_.data();
}

}  // namespace gigabake::kernels
