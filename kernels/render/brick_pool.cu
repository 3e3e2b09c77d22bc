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

/// Copies new bricks to the pool. Each block of threads copies one brick. `moves` lead from positions among the new
/// voxels to positions in the pool.
__global__ void scatter_bricks(const VoxelMove* moves, const CastHead* new_heads, const PackedVoxel* new_voxels,
                               CastHead* heads, PackedVoxel* voxels) {
  const VoxelMove move = moves[blockIdx.x];
  copy_voxels(new_voxels + move.from, move.count, voxels + move.to);
  if (threadIdx.x != 0) return;
  CastHead head = new_heads[blockIdx.x];
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

/// Layout of an upload of new bricks: heads, moves and voxels, one array after another.
struct NewBricks {
  std::size_t moves_at, voxels_at, bytes;

  NewBricks(std::size_t bricks, std::size_t voxel_count)
      : moves_at(bricks * sizeof(CastHead)),
        voxels_at(moves_at + bricks * sizeof(VoxelMove)),
        bytes(voxels_at + voxel_count * sizeof(PackedVoxel)) {}

  template <class Byte>
  auto heads(Byte* at) const {
    return array_at<CastHead>(at);
  }
  template <class Byte>
  auto moves(Byte* at) const {
    return array_at<VoxelMove>(at + moves_at);
  }
  template <class Byte>
  auto voxels(Byte* at) const {
    return array_at<PackedVoxel>(at + voxels_at);
  }

 private:
  template <class T>
  static T* array_at(std::byte* at) {
    return reinterpret_cast<T*>(at);
  }
  template <class T>
  static const T* array_at(const std::byte* at) {
    return reinterpret_cast<const T*>(at);
  }
};

std::uint32_t end_of(const VoxelMove& move) { return move.to + move.count; }

}  // namespace

BrickPool::BrickPool(DeviceHeap& heap, UploadRing& uploads, const ThreadPool& pool, const PoolSizes& sizes)
    : heap_(heap), uploads_(uploads), pool_(pool), heads_(heap, sizes.slots), voxels_(heap, sizes.voxels) {}

void BrickPool::show_in(CastScene& scene) const {
  scene.heads = heads_.data();
  scene.voxels = voxels_.data();
}

void BrickPool::put(const std::vector<BrickPlace>& places, const std::vector<CastBrick>& bricks) {
  const std::size_t count = places.size();
  std::vector<std::uint32_t> first{0};
  for (std::size_t i = 0; i < count; ++i) first.push_back(first.back() + std::uint32_t(bricks[i].parts.size()));
  const NewBricks sections(count, first.back());
  std::byte* const buffer = uploads_.reserve(sections.bytes);
  pool_.parallel_for(count, bricks_per_range, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      sections.moves(buffer)[i] = {places[i].slot, first[i], places[i].first, first[i + 1] - first[i]};
      sections.heads(buffer)[i] = bricks[i].head;
      std::copy(bricks[i].parts.begin(), bricks[i].parts.end(), sections.voxels(buffer) + first[i]);
    }
  });
  const std::byte* const sent = uploads_.send();
  scatter_bricks<<<unsigned(count), brick_threads, 0, heap_.stream()>>>(
      sections.moves(sent), sections.heads(sent), sections.voxels(sent), heads_.data(), voxels_.data());
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
