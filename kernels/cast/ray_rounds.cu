#include "kernels/cast/ray_rounds.cuh"
#include "kernels/cast/tile_grid.cuh"

namespace gigabake::kernels {
namespace {

/// Blocks of a multiprocessor.
constexpr unsigned min_walking = 4, min_looking = 4, min_casting = 3;

/// Adds the rays of a warp's lanes that `is_in`. All lanes call this.
__device__ void append(bool is_in, std::uint32_t ray, const RayList& list) {
  const unsigned in = __ballot_sync(0xffffffffu, is_in ? 1 : 0);
  const unsigned lane = threadIdx.x % 32;
  std::uint32_t first = 0;
  if (lane == 0 && in != 0) first = atomicAdd(list.count, std::uint32_t(__popc(in)));
  first = __shfl_sync(0xffffffffu, first, 0);
  if (is_in) list.rays[first + std::uint32_t(__popc(in & ((1u << lane) - 1)))] = ray;
}

__device__ CastLine line_of(const RayPass& pass, std::uint32_t ray) {
  const auto width = std::uint32_t(pass.tile.width);
  return line_of_sight(pass.scene, pass.camera, pass.tile.x + int(ray % width), pass.tile.y + int(ray / width));
}

/// What became of a lane's ray.
__device__ void keep(const RayPass& pass, std::uint32_t index, CastTask task, CastRay& ray) {
  if (task == CastTask::none) finish_opaque(ray);
  pass.rays[index] = ray;
  if (task == CastTask::none && ray.lod >= 0) atomicAdd(pass.unfinished, 1ull);
}

/// A lane of a warp that walks, and its ray. Its CastPath stands beside it: see CastWalk.
struct WalkingLane {
  bool has_ray = false;
  std::uint32_t index = 0;
  CastRay ray;
  CastLine line;
  CastWalk walk;
};

/// Rays whose turn comes, in the order in which warps take them. listed: null: those of the tile.
struct RayQueue {
  const std::uint32_t* listed;
  const std::uint32_t* count;  ///< of listed
  std::uint32_t* next;
  std::size_t begin, end;  ///< of the tile: all others are left out
};

/// Ray `turn` of the queue; false where it is none that is cast.
__device__ bool ray_of_turn(const RayPass& pass, const RayQueue& queue, std::uint32_t turn, std::uint32_t& index) {
  if (queue.listed != nullptr) {
    index = turn < *queue.count ? queue.listed[turn] : 0;
    return turn < *queue.count;
  }
  int x, y;
  const bool is_in = pixel_of_turn(pass.tile, turn, x, y);
  index = std::uint32_t(y) * std::uint32_t(pass.tile.width) + std::uint32_t(x);
  return is_in && index >= queue.begin && index < queue.end;
}

/// Puts away what came of the lane's ray, and takes another one.
__device__ void take_next(const RayPass& pass, const RayQueue& queue, std::uint32_t turn, WalkingLane& lane) {
  if (lane.has_ray) keep(pass, lane.index, lane.walk.task, lane.ray);
  lane.has_ray = ray_of_turn(pass, queue, turn, lane.index);
  lane.walk = CastWalk();
  if (!lane.has_ray) return;
  lane.ray = pass.rays[lane.index];
  lane.walk.task = first_task(true, lane.ray);
  lane.has_ray = lane.walk.task != CastTask::none;
  if (lane.has_ray) lane.line = line_of(pass, lane.index);
}

/// Lanes of a warp that are idle before they take other rays: taking them costs as much as some steps.
constexpr int idle_lanes = 8;

/// Walks all rays of the queue until they meet a sheet, are finished or wait. Lanes whose rays have take others: rays
/// differ in how far they walk, and a warp takes as long as all of its lanes together do.
__global__ void __launch_bounds__(tile_threads, min_walking) walk(RayPass pass, RayQueue queue, RayList met) {
  const std::uint32_t turns = queue.listed != nullptr ? *queue.count : turns_of(pass.tile);
  WalkingLane lane;
  CastPath path;
  bool is_left = true;
  for (;;) {
    const bool is_idle = lane.walk.task == CastTask::none || lane.walk.task == CastTask::meet;
    const unsigned idle = __ballot_sync(0xffffffffu, is_idle ? 1 : 0);
    if (idle == 0xffffffffu || (is_left && __popc(idle) >= idle_lanes)) {
      append(lane.has_ray && lane.walk.task == CastTask::meet, lane.index, met);
      std::uint32_t first = 0;
      if (is_left && threadIdx.x % 32 == 0) first = atomicAdd(queue.next, std::uint32_t(__popc(idle)));
      first = is_left ? __shfl_sync(0xffffffffu, first, 0) : turns;
      if (is_idle) take_next(pass, queue, first + std::uint32_t(__popc(idle & ((1u << threadIdx.x % 32) - 1))), lane);
      if (!is_left && idle == 0xffffffffu) return;
      is_left = first < turns;
    }
    walk_on(pass.scene, pass.camera, lane.line, pass.patient, lane.walk, path, lane.ray);
  }
}

__global__ void __launch_bounds__(tile_threads, min_looking)
    look_at_sheets(RayPass pass, RayList met, RayList going_on) {
  const std::uint32_t count = *met.count, first = blockIdx.x * blockDim.x;
  if (first >= count) return;
  const bool is_in = first + threadIdx.x < count;
  CastWalk walk;
  CastPath path;
  const std::uint32_t index = is_in ? met.rays[first + threadIdx.x] : 0;
  if (is_in) {
    CastRay ray = pass.rays[index];
    pass_sheet(pass.scene, pass.camera, line_of(pass, index), pass.patient, walk, path, ray);
    keep(pass, index, walk.task, ray);
  }
  append(walk.task == CastTask::seek, index, going_on);
}

/// What is left after some rounds, to its end.
__global__ void __launch_bounds__(tile_threads, min_casting) cast_listed(RayPass pass, RayList from) {
  const std::uint32_t count = *from.count, first = blockIdx.x * blockDim.x;
  if (first >= count) return;
  const bool is_in = first + threadIdx.x < count;
  const std::uint32_t index = is_in ? from.rays[first + threadIdx.x] : 0;
  CastRay ray;
  if (is_in) ray = pass.rays[index];
  cast_ray(pass.scene, pass.camera, line_of(pass, index), pass.patient, is_in, ray);
  if (is_in) keep(pass, index, CastTask::none, ray);
}

/// Of the kernel that walks, on the device that is set.
unsigned blocks_at_once() {
  int device = 0, processors = 0, blocks = 0;
  check_cuda(cudaGetDevice(&device), "cudaGetDevice");
  check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device), "cudaDeviceGetAttribute");
  check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, walk, int(tile_threads), 0),
             "cudaOccupancyMaxActiveBlocksPerMultiprocessor");
  return unsigned(processors * blocks);
}

}  // namespace

RayRounds::RayRounds(DeviceHeap& heap, cudaStream_t stream)
    : heap_(heap), stream_(stream), walking_blocks_(blocks_at_once()), counts_(heap, 3 * rounds) {}

void RayRounds::cast(const RayPass& pass, std::size_t begin, std::size_t end) {
  const std::size_t rays = std::size_t(pass.tile.width) * std::size_t(pass.tile.height);
  if (met_.size() < rays) {
    met_ = DeviceArray<std::uint32_t>(heap_, rays);
    going_on_ = DeviceArray<std::uint32_t>(heap_, rays);
  }
  counts_.clear_to_zero();
  const unsigned grid = grid_of(rays, tile_threads);
  RayList going_on{going_on_.data(), counts_.data()};
  for (std::size_t round = 0; round < rounds; ++round) {
    const RayList met{met_.data(), counts_.data() + 2 * round};
    const RayQueue queue{round == 0 ? nullptr : going_on.rays, going_on.count, counts_.data() + 2 * rounds + round,
                         begin, end};
    walk<<<walking_blocks_, tile_threads, 0, stream_>>>(pass, queue, met);
    check_launch("walk");
    going_on.count = counts_.data() + 2 * round + 1;
    look_at_sheets<<<grid, tile_threads, 0, stream_>>>(pass, met, going_on);
    check_launch("look_at_sheets");
  }
  cast_listed<<<grid, tile_threads, 0, stream_>>>(pass, going_on);
  check_launch("cast_listed");
}

}  // namespace gigabake::kernels
