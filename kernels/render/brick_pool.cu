#include <algorithm>

#include "kernels/cuda/device/stream.cuh"
#include "kernels/render/brick_pool.cuh"

namespace gigabake::kernels {
namespace {

/// The capacity of the temporary buffer in voxels.
constexpr std::size_t move_buffer_voxels = std::size_t(1) << 20;
constexpr unsigned brick_threads = 128;
/// The number of bricks that a thread of the host prepares for upload in one step.
constexpr std::size_t bricks_per_range = 64;

__device__ void copy_voxels(const PackedVoxel* from, std::uint32_t count, PackedVoxel* to) {
  const std::uint32_t* words = from->word;
  for (std::size_t i = threadIdx.x; i < std::size_t(3) * count; i += blockDim.x) to->word[i] = words[i];
}

/// The runs of a new brick, and the pages that they name.
struct NewRuns {
  std::uint32_t first, count;
  std::int32_t lod;
  PooledPage pages[max_brick_pages];
};

/// The parts of an upload of new bricks.
struct NewBrickArrays {
  const VoxelMove* moves;  ///< from positions among `voxels` to positions in the pool
  const CastHead* heads;
  const NewRuns* runs_of;
  const VoxelRun* runs;
  const PackedVoxel* voxels;
};

/// Copies new bricks to the pool, and then the voxels of their runs out of the page pool. Each block of threads copies
/// one brick.
__global__ void scatter_bricks(NewBrickArrays bricks, StoredVoxelShading shading, StoredVoxels pages, CastHead* heads,
                               PackedVoxel* voxels) {
  const VoxelMove move = bricks.moves[blockIdx.x];
  copy_voxels(bricks.voxels + move.from, move.count, voxels + move.to);
  CastHead head = bricks.heads[blockIdx.x];
  const NewRuns& own = bricks.runs_of[blockIdx.x];
  for (std::uint32_t i = threadIdx.x; i < own.count; i += blockDim.x) {
    const VoxelRun run = bricks.runs[own.first + i];
    write_run(shading, own.lod, voxels_of(pages, own.pages[run.page]), run, {head.layers, move.from, bricks.voxels},
              voxels + move.to);
  }
  if (threadIdx.x != 0) return;
  head.first = move.to;
  heads[move.slot] = head;
}

/// Copies bricks to the temporary buffer. Each block of threads copies one brick. `window` is the buffer; its first
/// voxel will be moved to position moves[0].to of the pool.
__global__ void gather_bricks(const VoxelMove* moves, const PackedVoxel* voxels, CastHead* heads, PackedVoxel* window) {
  const VoxelMove move = moves[blockIdx.x];
  copy_voxels(voxels + move.from, move.count, window + (move.to - moves[0].to));
  if (threadIdx.x == 0) heads[move.slot].first = move.to;
}

/// Layout of an upload of new bricks: one array after another, those with 16-byte alignment first.
class NewBricks {
 public:
  NewBricks(std::size_t bricks, std::size_t run_count, std::size_t voxel_count)
      : moves_at_(bricks * sizeof(CastHead)),
        runs_of_at_(moves_at_ + bricks * sizeof(VoxelMove)),
        runs_at_(runs_of_at_ + bricks * sizeof(NewRuns)),
        voxels_at_(runs_at_ + run_count * sizeof(VoxelRun)),
        bytes_(voxels_at_ + voxel_count * sizeof(PackedVoxel)) {}

  std::size_t bytes() const { return bytes_; }
  CastHead* heads(std::byte* at) const { return reinterpret_cast<CastHead*>(at); }
  VoxelMove* moves(std::byte* at) const { return reinterpret_cast<VoxelMove*>(at + moves_at_); }
  NewRuns* runs_of(std::byte* at) const { return reinterpret_cast<NewRuns*>(at + runs_of_at_); }
  VoxelRun* runs(std::byte* at) const { return reinterpret_cast<VoxelRun*>(at + runs_at_); }
  PackedVoxel* voxels(std::byte* at) const { return reinterpret_cast<PackedVoxel*>(at + voxels_at_); }

  NewBrickArrays arrays(const std::byte* at) const {
    return {reinterpret_cast<const VoxelMove*>(at + moves_at_), reinterpret_cast<const CastHead*>(at),
            reinterpret_cast<const NewRuns*>(at + runs_of_at_), reinterpret_cast<const VoxelRun*>(at + runs_at_),
            reinterpret_cast<const PackedVoxel*>(at + voxels_at_)};
  }

 private:
  std::size_t moves_at_, runs_of_at_, runs_at_, voxels_at_, bytes_;
};

std::uint32_t end_of(const VoxelMove& move) { return move.to + move.count; }

}  // namespace

BrickPool::BrickPool(DeviceHeap& heap, UploadRing& uploads, const ThreadPool& pool, const PoolSizes& sizes)
    : heap_(heap), uploads_(uploads), pool_(pool), heads_(heap, sizes.slots), voxels_(heap, sizes.voxels) {}

void BrickPool::show_in(CastScene& scene) const {
  scene.heads = heads_.data();
  scene.voxels = voxels_.data();
}

void BrickPool::put(const std::vector<BrickPlace>& places, const CastBricks& bricks, const DevicePagePool& pages) {
  const std::size_t count = places.size();
  std::vector<std::uint32_t> first{0}, first_run{0};
  for (std::size_t i = 0; i < count; ++i) {
    first.push_back(first.back() + std::uint32_t(bricks[i]->parts.size()));
    first_run.push_back(first_run.back() + std::uint32_t(bricks[i]->runs.size()));
  }
  const NewBricks sections(count, first_run.back(), first.back());
  std::byte* const buffer = uploads_.reserve(sections.bytes());
  pool_.parallel_for(count, bricks_per_range, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      const CastBrick& brick = *bricks[i];
      sections.moves(buffer)[i] = {places[i].slot, first[i], places[i].first, first[i + 1] - first[i]};
      sections.heads(buffer)[i] = brick.head;
      NewRuns& own = sections.runs_of(buffer)[i];
      own.first = first_run[i];
      own.count = std::uint32_t(brick.runs.size());
      own.lod = brick.lod;
      std::copy(brick.pages.begin(), brick.pages.end(), own.pages);
      std::copy(brick.runs.begin(), brick.runs.end(), sections.runs(buffer) + first_run[i]);
      std::copy(brick.parts.begin(), brick.parts.end(), sections.voxels(buffer) + first[i]);
    }
  });
  const std::byte* const sent = uploads_.send();
  scatter_bricks<<<unsigned(count), brick_threads, 0, heap_.stream()>>>(sections.arrays(sent), pages.shading(),
                                                                        pages.voxels(), heads_.data(), voxels_.data());
  check_launch("scatter_bricks");
}

/// Moves voxels through a temporary buffer, because sources and destinations overlap. A later source always lies above
/// all destinations written before it.
void BrickPool::move(const std::vector<VoxelMove>& moves) {
  if (moves.empty()) return;
  const VoxelMove* const sent = uploads_.send(moves);
  if (move_buffer_.empty()) move_buffer_ = DeviceArray<PackedVoxel>(heap_, move_buffer_voxels);
  for (std::size_t begin = 0, end = 0; begin < moves.size(); begin = end) {
    while (end < moves.size() && end_of(moves[end]) - moves[begin].to <= move_buffer_voxels) ++end;
    gather_bricks<<<unsigned(end - begin), brick_threads, 0, heap_.stream()>>>(sent + begin, voxels_.data(),
                                                                               heads_.data(), move_buffer_.data());
    check_launch("gather_bricks");
    const std::size_t count = end_of(moves[end - 1]) - moves[begin].to;
    check_cuda(cudaMemcpyAsync(voxels_.data() + moves[begin].to, move_buffer_.data(), count * sizeof(PackedVoxel),
                               cudaMemcpyDeviceToDevice, heap_.stream()),
               "cudaMemcpyAsync");
  }
}

}  // namespace gigabake::kernels
