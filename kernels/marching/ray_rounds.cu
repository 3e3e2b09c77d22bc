#include "kernels/marching/ray_rounds.cuh"
#include "kernels/marching/tile_grid.cuh"

namespace gigabake::kernels {
namespace {

/// Blocks per multiprocessor, measured on an H200. Four traversal blocks are faster than five, because with four no
/// registers spill.
constexpr unsigned min_traversal = 4, min_sampling = 4, min_casting = 3;

__device__ CastLine line_of(const RayPass& pass, std::uint32_t ray) {
  const auto width = std::uint32_t(pass.tile.width);
  return line_of_sight(pass.scene, pass.camera, pass.tile.x + int(ray % width), pass.tile.y + int(ray / width));
}

/// Stores a lane's ray. Counts the ray as waiting if it is unfinished and has no further task.
__device__ void keep(const RayPass& pass, std::uint32_t index, CastTask task, CastRay& ray) {
  if (task == CastTask::none) finish_opaque(ray);
  pass.rays[index] = ray;
  if (task == CastTask::none && ray.lod >= 0) atomicAdd(pass.unfinished, 1ull);
}

/// Traverses a ray and lists it if it hits a surface. All lanes of a warp participate. A ray that ends at its start is
/// stored too, because no other code initialises its entry.
template <RayType ray_type>
__device__ void traverse_and_list(const RayPass& pass, bool is_cast, bool starts, std::uint32_t index,
                                  const RayList& met) {
  MarchState march;
  CastPath path;
  CastRay ray;
  const CastLine line = line_of(pass, index);
  if (is_cast) ray = starts ? start_ray(pass.scene, line) : pass.rays[index];
  start_march(pass.scene, line, is_cast, ray, march);
  is_cast = march.task != CastTask::none || (is_cast && starts);
  march_to_surface<ray_type>(pass.scene, pass.camera, line, pass.blocking, march, path, ray);
  if (is_cast) keep(pass, index, march.task, ray);
  append(march.task == CastTask::meet, index, met);
}

template <RayType ray_type>
__global__ void __launch_bounds__(tile_threads, min_traversal)
    traverse_tile(const __grid_constant__ RayPass pass, std::size_t begin, std::size_t end, RayList met) {
  int x, y;
  const bool is_in = pixel_of_thread(pass.tile, x, y);
  const std::size_t i = std::size_t(y) * std::size_t(pass.tile.width) + std::size_t(x);
  traverse_and_list<ray_type>(pass, is_in && i >= begin && i < end, pass.starts, std::uint32_t(i), met);
}

template <RayType ray_type>
__global__ void __launch_bounds__(tile_threads, min_traversal)
    traverse_listed(const __grid_constant__ RayPass pass, RayList from, RayList met) {
  const std::uint32_t count = *from.count, first = blockIdx.x * blockDim.x;
  if (first >= count) return;
  const bool is_in = first + threadIdx.x < count;
  traverse_and_list<ray_type>(pass, is_in, false, is_in ? from.rays[first + threadIdx.x] : 0, met);
}

template <RayType ray_type>
__global__ void __launch_bounds__(tile_threads, min_sampling)
    sample_surface(const __grid_constant__ RayPass pass, RayList met, RayList continuing) {
  const std::uint32_t count = *met.count, first = blockIdx.x * blockDim.x;
  if (first >= count) return;
  const bool is_in = first + threadIdx.x < count;
  MarchState march;
  CastPath path;
  const std::uint32_t index = is_in ? met.rays[first + threadIdx.x] : 0;
  if (is_in) {
    CastRay ray = pass.rays[index];
    pass_surface<ray_type>(pass.scene, pass.camera, line_of(pass, index), pass.blocking, march, path, ray);
    keep(pass, index, march.task, ray);
  }
  append(march.task == CastTask::seek, index, continuing);
}

/// Casts the rays that remain after the waves, until they are finished or wait.
template <RayType ray_type>
__global__ void __launch_bounds__(tile_threads, min_casting)
    cast_listed(const __grid_constant__ RayPass pass, RayList from) {
  const std::uint32_t count = *from.count, first = blockIdx.x * blockDim.x;
  if (first >= count) return;
  const bool is_in = first + threadIdx.x < count;
  const std::uint32_t index = is_in ? from.rays[first + threadIdx.x] : 0;
  CastRay ray;
  if (is_in) ray = pass.rays[index];
  cast_ray<ray_type>(pass.scene, pass.camera, line_of(pass, index), pass.blocking, is_in, ray);
  if (is_in) keep(pass, index, CastTask::none, ray);
}

}  // namespace

void RayRounds::cast(const RayPass& pass, std::size_t begin, std::size_t end) {
  if (pass.scene.is_lit)
    cast_as<RayType::lit>(pass, begin, end);
  else
    cast_as<RayType::primary>(pass, begin, end);
}

template <RayType ray_type>
void RayRounds::cast_as(const RayPass& pass, std::size_t begin, std::size_t end) {
  const std::size_t rays = std::size_t(pass.tile.width) * std::size_t(pass.tile.height);
  if (met_.size() < rays) {
    met_ = DeviceArray<std::uint32_t>(heap_, rays);
    continuing_ = DeviceArray<std::uint32_t>(heap_, rays);
  }
  counts_.clear_to_zero();
  const unsigned grid = grid_of(rays, tile_threads);
  RayList continuing{continuing_.data(), counts_.data()};
  for (std::size_t round = 0; round < rounds; ++round) {
    const RayList met{met_.data(), counts_.data() + 2 * round};
    if (round == 0)
      traverse_tile<ray_type><<<grid_of_tile(pass.tile), tile_threads, 0, stream_>>>(pass, begin, end, met);
    else
      traverse_listed<ray_type><<<grid, tile_threads, 0, stream_>>>(pass, continuing, met);
    check_launch("walk");
    continuing.count = counts_.data() + 2 * round + 1;
    sample_surface<ray_type><<<grid, tile_threads, 0, stream_>>>(pass, met, continuing);
    check_launch("look_at_sheets");
  }
  cast_listed<ray_type><<<grid, tile_threads, 0, stream_>>>(pass, continuing);
  check_launch("cast_listed");
}

}  // namespace gigabake::kernels
