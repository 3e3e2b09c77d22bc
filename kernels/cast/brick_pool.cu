#include <algorithm>
#include <cstring>

#include "kernels/cast/brick_pool.cuh"
#include "kernels/cuda/input.cuh"
#include "kernels/cuda/stream.cuh"

namespace gigabake::kernels {
namespace {

/// Voxels that are moved by way of another place at a time.
constexpr std::size_t voxels_on_their_way = std::size_t(1) << 20;
constexpr unsigned brick_threads = 128;

__device__ void copy_voxels(const PackedVoxel* from, std::uint32_t count, PackedVoxel* to) {
  const std::uint32_t* words = from->word;
  for (std::size_t i = threadIdx.x; i < std::size_t(3) * count; i += blockDim.x) to->word[i] = words[i];
}

/// A block a brick. moves: from a place among the new voxels to one in the pool.
__global__ void scatter_bricks(const VoxelMove* moves, const CastMask* new_masks, const CastLayer* new_layers,
                               const PackedVoxel* new_voxels, CastMask* masks, CastLayer* layers, PackedVoxel* voxels) {
  const VoxelMove move = moves[blockIdx.x];
  copy_voxels(new_voxels + move.from, move.count, voxels + move.to);
  if (threadIdx.x == 0) masks[move.slot] = new_masks[blockIdx.x];
  if (threadIdx.x >= slot_edge) return;
  CastLayer layer = new_layers[slot_edge * blockIdx.x + threadIdx.x];
  layer.first += move.to;
  layers[std::size_t(slot_edge) * move.slot + threadIdx.x] = layer;
}

/// A block a brick. window: from where in the pool they will stand on.
__global__ void gather_bricks(const VoxelMove* moves, const PackedVoxel* voxels, CastLayer* layers,
                              PackedVoxel* window) {
  const VoxelMove move = moves[blockIdx.x];
  copy_voxels(voxels + move.from, move.count, window + (move.to - moves[0].to));
  if (threadIdx.x < slot_edge) layers[std::size_t(slot_edge) * move.slot + threadIdx.x].first -= move.from - move.to;
}

std::uint32_t end_of(const VoxelMove& move) { return move.to + move.count; }

}  // namespace

BrickPool::BrickPool(DeviceHeap& heap, const PoolSizes& sizes)
    : heap_(heap),
      masks_(heap, sizes.slots),
      layers_(heap, std::size_t(slot_edge) * sizes.slots),
      voxels_(heap, sizes.voxels) {}

void BrickPool::show_in(CastScene& scene) const {
  scene.masks = masks_.data();
  scene.layers = layers_.data();
  scene.voxels = voxels_.data();
}

/// fill: puts `count` values where it is told to. Returns when they are on the device.
template <class T, class Fill>
void BrickPool::upload(DeviceArray<T>& device, std::size_t count, const Fill& fill) {
  if (device.size() < count) device = DeviceArray<T>(heap_, count);
  T* const host = reinterpret_cast<T*>(pinned_.reserve(count * sizeof(T)));
  fill(host);
  check_cuda(cudaMemcpyAsync(device.data(), host, count * sizeof(T), cudaMemcpyHostToDevice, heap_.stream()),
             "cudaMemcpyAsync");
  check_cuda(cudaStreamSynchronize(heap_.stream()), "cudaMemcpyAsync");
}

void BrickPool::put(const std::vector<BrickPlace>& places, const std::vector<CastBrick>& bricks) {
  std::vector<VoxelMove> moves;
  std::uint32_t voxels = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto count = std::uint32_t(bricks[i].voxels.size());
    moves.push_back({places[i].slot, voxels, places[i].first, count});
    voxels += count;
  }
  upload(moves_, moves.size(), [&](VoxelMove* to) { std::copy(moves.begin(), moves.end(), to); });
  upload(new_masks_, moves.size(), [&](CastMask* to) {
    for (std::size_t i = 0; i < moves.size(); ++i) to[i] = bricks[i].mask;
  });
  upload(new_layers_, slot_edge * moves.size(), [&](CastLayer* to) {
    for (std::size_t i = 0; i < moves.size(); ++i) std::copy_n(bricks[i].layers, slot_edge, to + slot_edge * i);
  });
  upload(new_voxels_, voxels, [&](PackedVoxel* to) {
    for (std::size_t i = 0; i < moves.size(); ++i)
      std::copy(bricks[i].voxels.begin(), bricks[i].voxels.end(), to + moves[i].from);
  });
  scatter_bricks<<<unsigned(moves.size()), brick_threads, 0, heap_.stream()>>>(
      moves_.data(), new_masks_.data(), new_layers_.data(), new_voxels_.data(), masks_.data(), layers_.data(),
      voxels_.data());
  check_launch("scatter_bricks");
  check_cuda(cudaStreamSynchronize(heap_.stream()), "scatter_bricks");
}

/// Places overlap, so voxels go by way of a third one. What is read later stands higher than all that was written.
void BrickPool::move(const std::vector<VoxelMove>& moves) {
  if (moves.empty()) return;
  upload(moves_, moves.size(), [&](VoxelMove* to) { std::copy(moves.begin(), moves.end(), to); });
  if (on_its_way_.empty()) on_its_way_ = DeviceArray<PackedVoxel>(heap_, voxels_on_their_way);
  for (std::size_t begin = 0, end = 0; begin < moves.size(); begin = end) {
    while (end < moves.size() && end_of(moves[end]) - moves[begin].to <= voxels_on_their_way) ++end;
    gather_bricks<<<unsigned(end - begin), brick_threads, 0, heap_.stream()>>>(moves_.data() + begin, voxels_.data(),
                                                                               layers_.data(), on_its_way_.data());
    check_launch("gather_bricks");
    const std::size_t count = end_of(moves[end - 1]) - moves[begin].to;
    check_cuda(cudaMemcpyAsync(voxels_.data() + moves[begin].to, on_its_way_.data(), count * sizeof(PackedVoxel),
                               cudaMemcpyDeviceToDevice, heap_.stream()),
               "cudaMemcpyAsync");
  }
  check_cuda(cudaStreamSynchronize(heap_.stream()), "gather_bricks");
}

}  // namespace gigabake::kernels
