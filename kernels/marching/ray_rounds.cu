#include <algorithm>

#include "kernels/marching/ray_rounds.cuh"
#include "kernels/marching/tile_grid.cuh"

namespace gigabake::kernels {
namespace {

/// The parts of the work of rays between surfaces, each done by its own kernel.
enum class Stage : std::uint8_t {
  find,     ///< find bricks, and skip empty space, until a sample is not empty
  pass,     ///< process samples, except those with a residual
  residual  ///< process samples with and without residuals
};

/// Returns the task with which rays begin a stage.
__device__ constexpr CastTask first_task(Stage stage) { return stage == Stage::find ? CastTask::find : CastTask::pass; }

/// Blocks per multiprocessor, measured on an H200.
constexpr unsigned min_marching = 4, min_meeting = 4, min_casting = 3;

/// A warp takes new rays when at most this many of its lanes work.
constexpr int max_working_lanes = 16;

/// The max number of a warp's last rays, and the min number of tasks before these rays continue in the next round.
/// There they share a warp with others. Only rays in the stage `find` do so.
constexpr int max_last_lanes = 8, min_last_tasks = 48;

__device__ CastLine line_of(const RayPass& pass, std::uint32_t ray) {
  const auto width = std::uint32_t(pass.tile.width);
  return line_of_sight(pass.scene, pass.camera, pass.tile.x + int(ray % width), pass.tile.y + int(ray / width));
}

/// Counts the ray as waiting if it is unfinished and has no further task.
__device__ void count_waiting(const RayPass& pass, CastTask task, const CastRay& ray) {
  if (task == CastTask::none && ray.lod >= 0) atomicAdd(pass.unfinished, 1ull);
}

/// Stores a lane's ray.
__device__ void keep(const RayPass& pass, std::uint32_t index, CastTask task, CastRay& ray) {
  if (task == CastTask::none) finish_opaque(ray);
  pass.rays[index] = ray;
  count_waiting(pass, task, ray);
}

/// Stores the members of a lane's ray that the stage `find` changes.
__device__ void keep_place(const RayPass& pass, std::uint32_t index, CastTask task, const CastRay& ray) {
  CastRay& kept = pass.rays[index];
  kept.step = ray.step;
  kept.past = ray.past;
  kept.met = ray.met;
  kept.signed_distance = ray.signed_distance;
  kept.lod = ray.lod;
  kept.is_seen = ray.is_seen;
  kept.normal = ray.normal;
  count_waiting(pass, task, ray);
}

/// Stores the brick of the ray's current sample.
__device__ void hold_brick(const RayPass& pass, std::uint32_t index, const MarchState& march) {
  pass.held[index] = {march.in_brick_until, march.brick, march.frame.cell, std::int16_t(march.lod), march.waits};
}

/// Continues with the current sample in the brick that hold_brick() stored. Leaves march.frame.column unset, because
/// only the stage `find` reads it.
__device__ void start_in_brick(const RayPass& pass, std::uint32_t index, MarchState& march) {
  const HeldBrick held = pass.held[index];
  march.task = CastTask::pass;
  march.in_brick_until = held.until;
  march.brick = held.brick;
  march.lod = held.lod;
  march.waits = held.waits;
  march.frame.cell = held.cell;
  march.frame.low = low_of(pass.scene, held.cell);
  march.head = load_head(pass.scene.heads + held.brick);
}

/// Counts the rays of a warp whose tasks belong to the stage.
template <Stage stage>
__device__ TaskLanes lanes_of(CastTask task) {
  TaskLanes lanes = task_lanes(task);
  (stage == Stage::find ? lanes.pass : lanes.find) = 0;
  return lanes;
}

/// Executes task `next` of the rays that have it.
template <Stage stage, RayType ray_type>
__device__ void do_task(CastTask next, const RayPass& pass, const CastLine& line, MarchState& march, CastPath& path,
                        CastRay& ray) {
  if (next == CastTask::step) {
    step_often(pass.scene, line, march, ray);
  } else if (march.task == next) {
    if constexpr (stage == Stage::find)
      enter_brick(pass.scene, line, pass.blocking, march, path, ray);
    else
      pass_point<ray_type, stage == Stage::pass ? Residuals::deferred : Residuals::composited>(pass.scene, pass.camera,
                                                                                               line, march, ray);
  }
}

/// Appends a ray that leaves its kernel to the list of its task, and stores its brick if another kernel needs it. A
/// sample in a brick that replaces missing data always has a residual. All lanes of the warp must call this function.
template <Stage stage>
__device__ void append_to_lists(const RayPass& pass, bool leaves, std::uint32_t index, const MarchState& march,
                                const RayLists& lists) {
  if (leaves && (march.task == CastTask::pass || march.task == CastTask::residual)) hold_brick(pass, index, march);
  append(leaves && (march.task == CastTask::find || march.task == CastTask::step), index, lists.find);
  const bool passes = leaves && march.task == CastTask::pass;
  if (stage == Stage::find) append(passes && !march.waits, index, lists.pass);
  if (stage == Stage::find) append(passes && march.waits, index, lists.residual);
  if (stage == Stage::pass) append(leaves && march.task == CastTask::residual, index, lists.residual);
  append(leaves && march.task == CastTask::meet, index, lists.meet);
}

/// Starts the rays of a part of the tile, or continues them, in the stage `find`. Part p has blocks p, p + parts, ….
/// Stores also rays that end at their start, because no other code initialises their entries.
__global__ void __launch_bounds__(tile_threads, min_marching)
    find_in_tile(const __grid_constant__ RayPass pass, std::size_t begin, std::size_t end, unsigned part,
                 unsigned parts, const __grid_constant__ RayLists lists) {
  int x, y;
  const bool is_in = pixel_of_thread(pass.tile, blockIdx.x * parts + part, x, y);
  const std::size_t i = std::size_t(y) * std::size_t(pass.tile.width) + std::size_t(x);
  const bool is_cast = is_in && i >= begin && i < end;
  const std::uint32_t index = is_cast ? std::uint32_t(i) : 0;
  MarchState march;
  CastPath path;
  CastRay ray;
  const CastLine line = line_of(pass, index);
  if (is_cast) ray = pass.starts ? start_ray(pass.scene, line) : pass.rays[index];
  start_march(pass.scene, line, is_cast, ray, march);
  const bool is_marching = march.task != CastTask::none;
  while (true) {
    const CastTask next = lanes_of<Stage::find>(march.task).next();
    if (next == CastTask::none) break;
    do_task<Stage::find, RayType::primary>(next, pass, line, march, path, ray);
  }
  if (is_cast && pass.starts) {
    pass.rays[index] = ray;
    count_waiting(pass, march.task, ray);
  } else if (is_marching) {
    keep_place(pass, index, march.task, ray);
  }
  append_to_lists<Stage::find>(pass, is_marching, index, march, lists);
}

/// The rays that the warps of a kernel take from its list.
struct Supply {
  RayList from;
  std::uint32_t* taken;  ///< entries that the kernel has taken
};

/// Executes one stage of the rays in a list. Warps take new rays for lanes whose rays need another stage.
template <Stage stage, RayType ray_type>
__global__ void __launch_bounds__(tile_threads, min_marching)
    march_listed(const __grid_constant__ RayPass pass, Supply supply, const __grid_constant__ RayLists lists) {
  const std::uint32_t count = *supply.from.count;
  if (count == 0) return;
  bool is_last = false, has_ray = false;
  int tasks = 0;
  std::uint32_t index = 0;
  MarchState march;
  CastPath path;
  CastRay ray;
  CastLine line;
  while (true) {
    const TaskLanes lanes = lanes_of<stage>(march.task);
    const int working = lanes.find + lanes.step + lanes.pass;
    const bool is_cut = stage == Stage::find && ++tasks > min_last_tasks;
    if (working > (!is_last ? max_working_lanes : is_cut ? max_last_lanes : 0)) {
      do_task<stage, ray_type>(lanes.next(), pass, line, march, path, ray);
      continue;
    }
    const bool works = march.task == CastTask::step || march.task == first_task(stage);
    const bool is_idle = is_last || !works;
    const bool leaves = has_ray && is_idle;
    if (leaves && stage == Stage::find) keep_place(pass, index, march.task, ray);
    if (leaves && stage != Stage::find) keep(pass, index, march.task, ray);
    append_to_lists<stage>(pass, leaves, index, march, lists);
    if (is_last) return;
    const ListPlace place = take_place(is_idle, supply.taken);
    is_last = place.end >= count;
    tasks = 0;
    if (!is_idle) continue;
    has_ray = place.own < count;
    march.task = CastTask::none;
    if (!has_ray) continue;
    index = supply.from.rays[place.own];
    line = line_of(pass, index);
    ray = pass.rays[index];
    path.cell = no_cell;
    march.frame = CellFrame{};
    start_march(pass.scene, line, true, ray, march);
    if (stage != Stage::find) start_in_brick(pass, index, march);
  }
}

/// Composites the surfaces that rays have hit.
template <RayType ray_type>
__global__ void __launch_bounds__(tile_threads, min_meeting)
    meet_listed(const __grid_constant__ RayPass pass, const __grid_constant__ RayLists lists) {
  const std::uint32_t count = *lists.meet.count;
  for (std::uint32_t first = blockIdx.x * blockDim.x; first < count; first += gridDim.x * blockDim.x) {
    const bool is_in = first + threadIdx.x < count;
    MarchState march;
    CastPath path;
    const std::uint32_t index = is_in ? lists.meet.rays[first + threadIdx.x] : 0;
    if (is_in) {
      CastRay ray = pass.rays[index];
      pass_surface<ray_type>(pass.scene, pass.camera, line_of(pass, index), pass.blocking, march, path, ray);
      keep(pass, index, march.task, ray);
    }
    append(march.task == CastTask::find, index, lists.find);
  }
}

/// Casts the rays that remain after the rounds, until they are finished or wait.
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

unsigned count_multiprocessors(int device) {
  int count = 0;
  check_cuda(cudaDeviceGetAttribute(&count, cudaDevAttrMultiProcessorCount, device), "cudaDeviceGetAttribute");
  return unsigned(count);
}

}  // namespace

RayRounds::RayRounds(DeviceHeap& heap, cudaStream_t stream, int device)
    : heap_(heap),
      stream_(stream),
      multiprocessors_(count_multiprocessors(device)),
      parts_{{heap, device}, {heap, device}} {}

void RayRounds::cast(const RayPass& pass, std::size_t begin, std::size_t end) {
  if (pass.scene.is_lit)
    cast_as<RayType::lit>(pass, begin, end);
  else
    cast_as<RayType::primary>(pass, begin, end);
}

template <RayType ray_type>
void RayRounds::cast_as(const RayPass& given, std::size_t begin, std::size_t end) {
  const std::size_t rays = std::size_t(given.tile.width) * std::size_t(given.tile.height);
  const unsigned blocks = grid_of(grid_of_tile(given.tile), parts);
  if (held_.size() < rays) held_ = DeviceArray<HeldBrick>(heap_, rays);
  RayPass pass = given;
  pass.held = held_.data();
  for (Part& part : parts_) make_lists(part, std::size_t(blocks) * tile_threads);
  check_cuda(cudaEventRecord(begun_.handle, stream_), "cudaEventRecord");
  for (unsigned p = 0; p < parts; ++p) {
    check_cuda(cudaStreamWaitEvent(parts_[p].stream.handle, begun_.handle), "cudaStreamWaitEvent");
    find_in_tile<<<blocks, tile_threads, 0, parts_[p].stream.handle>>>(pass, begin, end, p, unsigned(parts),
                                                                       lists_of(parts_[p], 0));
    check_launch("find_in_tile");
  }
  const std::size_t at_least = pass.resumes ? min_resumed_rounds : min_rounds;
  std::size_t round = 0;
  for (; round < at_least || (round < max_rounds && has_long_list(round)); ++round)
    for (Part& part : parts_) cast_round<ray_type>(pass, blocks, round, part);
  for (Part& part : parts_) {
    cast_listed<ray_type><<<blocks, tile_threads, 0, part.stream.handle>>>(pass, lists_of(part, round - 1).find);
    check_launch("cast_listed");
    check_cuda(cudaEventRecord(part.done.handle, part.stream.handle), "cudaEventRecord");
    check_cuda(cudaStreamWaitEvent(stream_, part.done.handle), "cudaStreamWaitEvent");
  }
}

void RayRounds::make_lists(Part& part, std::size_t rays) {
  for (DeviceArray<std::uint32_t>* list : {&part.find[0], &part.find[1], &part.pass, &part.residual, &part.meet})
    if (list->size() < rays) *list = DeviceArray<std::uint32_t>(heap_, rays);
  part.counts.clear_to_zero();
}

/// Tests whether the list of a part has more rays than the last kernel works on at twice. Waits for the rounds before.
bool RayRounds::has_long_list(std::size_t round) {
  auto* const left = reinterpret_cast<std::uint32_t*>(left_.reserve(parts * sizeof(std::uint32_t)));
  for (std::size_t p = 0; p < parts; ++p)
    download_async(left + p, &parts_[p].counts.data()[round].find, sizeof left[p], parts_[p].stream.handle,
                   "cudaMemcpyAsync");
  for (const Part& part : parts_) check_cuda(cudaStreamSynchronize(part.stream.handle), "cudaStreamSynchronize");
  return *std::max_element(left, left + parts) > 2 * multiprocessors_ * min_casting * tile_threads;
}

/// Returns the lists that a round fills. Its rays with the task `find` belong to the next round.
RayLists RayRounds::lists_of(Part& part, std::size_t round) const {
  RoundCounts* const counts = part.counts.data() + round;
  return {{part.find[(round + 1) % 2].data(), &counts[1].find},
          {part.pass.data(), &counts->pass},
          {part.residual.data(), &counts->residual},
          {part.meet.data(), &counts->meet}};
}

template <RayType ray_type>
void RayRounds::cast_round(const RayPass& pass, unsigned blocks, std::size_t round, Part& part) {
  RoundCounts* const counts = part.counts.data() + round;
  const RayLists lists = lists_of(part, round);
  const unsigned marching = std::min(blocks, multiprocessors_ * min_marching);
  const cudaStream_t stream = part.stream.handle;
  if (round > 0) {
    const Supply supply{{part.find[round % 2].data(), &counts->find}, &counts->found};
    march_listed<Stage::find, RayType::primary><<<marching, tile_threads, 0, stream>>>(pass, supply, lists);
    check_launch("find");
  }
  march_listed<Stage::pass, RayType::lit>
      <<<marching, tile_threads, 0, stream>>>(pass, Supply{lists.pass, &counts->passed}, lists);
  check_launch("pass");
  march_listed<Stage::residual, ray_type>
      <<<marching, tile_threads, 0, stream>>>(pass, Supply{lists.residual, &counts->composited}, lists);
  check_launch("residual");
  meet_listed<ray_type><<<round == 0 ? blocks : grid_of(blocks, 4), tile_threads, 0, stream>>>(pass, lists);
  check_launch("meet_listed");
}

}  // namespace gigabake::kernels
