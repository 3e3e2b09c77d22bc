#include "kernels/marching/blend_passes.cuh"
#include "kernels/marching/tile_grid.cuh"

namespace gigabake::kernels {
namespace {

__global__ void start_coarser_rays(RayPass pass, CastRay* coarser) {
  int x, y;
  if (!pixel_of_thread(pass.tile, x, y)) return;
  const int i = y * pass.tile.width + x, px = pass.tile.x + x, py = pass.tile.y + y;
  coarser[i] = start_coarser(pass.scene, line_of_sight(pass.scene, pass.camera, px, py),
                             line_of_sight(pass.scene, coarser_camera(pass.camera), px, py), pass.rays[i]);
}

__global__ void blend_rays(RayPass pass, const CastRay* coarser) {
  int x, y;
  if (!pixel_of_thread(pass.tile, x, y)) return;
  const int i = y * pass.tile.width + x;
  const CastLine line = line_of_sight(pass.scene, pass.camera, pass.tile.x + x, pass.tile.y + y);
  pass.rays[i] = blended(pass.scene, line, pass.rays[i], coarser[i]);
}

}  // namespace

void BlendPasses::start(const RayPass& pass) {
  const std::size_t rays = std::size_t(pass.tile.width) * std::size_t(pass.tile.height);
  if (coarser_.size() < rays) coarser_ = DeviceArray<CastRay>(heap_, rays);
  start_coarser_rays<<<grid_of_tile(pass.tile), tile_threads, 0, stream_>>>(pass, coarser_.data());
  check_launch("start_coarser_rays");
}

void BlendPasses::cast(RayRounds& rounds, const RayPass& pass, std::size_t begin, std::size_t end) {
  RayPass second = pass;
  second.camera = coarser_camera(pass.camera);
  second.rays = coarser_.data();
  rounds.cast(second, begin, end);
}

void BlendPasses::blend(const RayPass& pass) {
  blend_rays<<<grid_of_tile(pass.tile), tile_threads, 0, stream_>>>(pass, coarser_.data());
  check_launch("blend_rays");
}

}  // namespace gigabake::kernels
