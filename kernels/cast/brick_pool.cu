#include <algorithm>

#include "kernels/cast/brick_pool.cuh"
#include "kernels/cuda/stream.cuh"

namespace gigabake::kernels {
namespace {

/// Voxels that are moved by way of another place at a time.
constexpr std::size_t voxels_on_their_way = std::size_t(1) << 20;
constexpr unsigned brick_threads = 128;
/// Bricks that a thread of the host makes ready to be sent at a time.
constexpr std::size_t bricks_per_range = 64;

/// A block a brick. moves: from a place among the new voxels to one in the pool.
__global__ void scatter_bricks(const VoxelMove* moves, const CastMask* new_masks, const CastLayer* new_layers,
                               const PackedVoxel* new_voxels, CastMask* masks, CastLayer* layers, VoxelArrays voxels) {
  const VoxelMove move = moves[blockIdx.x];
  for (std::uint32_t i = threadIdx.x; i < move.count; i += blockDim.x) {
    const PackedVoxel voxel = new_voxels[move.from + i];
    voxels.surfaces[move.to + i] = surface_of(voxel);
    voxels.radiances[move.to + i] = voxel.word[0];
  }
  if (threadIdx.x == 0) masks[move.slot] = new_masks[blockIdx.x];
  if (threadIdx.x >= slot_edge) return;
  CastLayer layer = new_layers[slot_edge * blockIdx.x + threadIdx.x];
  layer.first += move.to;
  layers[std::size_t(slot_edge) * move.slot + threadIdx.x] = layer;
}

/// A block a brick. window: from where in the pool they will stand on.
__global__ void gather_bricks(const VoxelMove* moves, VoxelArrays voxels, CastLayer* layers, VoxelArrays window) {
  const VoxelMove move = moves[blockIdx.x];
  const std::uint32_t first = move.to - moves[0].to;
  for (std::uint32_t i = threadIdx.x; i < move.count; i += blockDim.x) {
    window.surfaces[first + i] = voxels.surfaces[move.from + i];
    window.radiances[first + i] = voxels.radiances[move.from + i];
  }
  if (threadIdx.x < slot_edge) layers[std::size_t(slot_edge) * move.slot + threadIdx.x].first -= move.from - move.to;
}

/// What is sent of new bricks: their masks, layers, moves and voxels, one array after another.
struct NewBricks {
  std::size_t layers_at, moves_at, voxels_at, bytes;

  NewBricks(std::size_t bricks, std::size_t voxel_count)
      : layers_at(bricks * sizeof(CastMask)),
        moves_at(layers_at + bricks * slot_edge * sizeof(CastLayer)),
        voxels_at(moves_at + bricks * sizeof(VoxelMove)),
        bytes(voxels_at + voxel_count * sizeof(PackedVoxel)) {}

  template <class Byte>
  auto masks(Byte* at) const {
    return array_at<CastMask>(at);
  }
  template <class Byte>
  auto layers(Byte* at) const {
    return array_at<CastLayer>(at + layers_at);
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

BrickPool::BrickPool(DeviceHeap& heap, Delivery& delivery, const ThreadPool& pool, const PoolSizes& sizes)
    : heap_(heap),
      delivery_(delivery),
      pool_(pool),
      masks_(heap, sizes.slots),
      layers_(heap, std::size_t(slot_edge) * sizes.slots),
      surfaces_(heap, sizes.voxels),
      radiances_(heap, sizes.voxels) {}

void BrickPool::show_in(CastScene& scene) const {
  scene.masks = masks_.data();
  scene.layers = layers_.data();
  scene.voxels = {surfaces_.data(), radiances_.data()};
}

void BrickPool::put(const std::vector<BrickPlace>& places, const std::vector<CastBrick>& bricks) {
  const std::size_t count = places.size();
  std::vector<std::uint32_t> first{0};
  for (std::size_t i = 0; i < count; ++i) first.push_back(first.back() + std::uint32_t(bricks[i].voxels.size()));
  const NewBricks parts(count, first.back());
  std::byte* const room = delivery_.room(parts.bytes);
  pool_.parallel_for(count, bricks_per_range, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      parts.moves(room)[i] = {places[i].slot, first[i], places[i].first, first[i + 1] - first[i]};
      parts.masks(room)[i] = bricks[i].mask;
      std::copy_n(bricks[i].layers, slot_edge, parts.layers(room) + slot_edge * i);
      std::copy(bricks[i].voxels.begin(), bricks[i].voxels.end(), parts.voxels(room) + first[i]);
    }
  });
  const std::byte* const sent = delivery_.send();
  scatter_bricks<<<unsigned(count), brick_threads, 0, heap_.stream()>>>(parts.moves(sent), parts.masks(sent),
                                                                        parts.layers(sent), parts.voxels(sent),
                                                                        masks_.data(), layers_.data(), voxels());
  check_launch("scatter_bricks");
}

template <class T>
void BrickPool::copy_on_device(const T* from, std::size_t count, T* to) {
  check_cuda(cudaMemcpyAsync(to, from, count * sizeof(T), cudaMemcpyDeviceToDevice, heap_.stream()), "cudaMemcpyAsync");
}

/// Places overlap, so voxels go by way of a third one. What is read later stands higher than all that was written.
void BrickPool::move(const std::vector<VoxelMove>& moves) {
  if (moves.empty()) return;
  const VoxelMove* const sent = delivery_.send(moves);
  if (surfaces_on_their_way_.empty()) {
    surfaces_on_their_way_ = DeviceArray<PackedSurface>(heap_, voxels_on_their_way);
    radiances_on_their_way_ = DeviceArray<std::uint32_t>(heap_, voxels_on_their_way);
  }
  const VoxelArrays window{surfaces_on_their_way_.data(), radiances_on_their_way_.data()};
  for (std::size_t begin = 0, end = 0; begin < moves.size(); begin = end) {
    while (end < moves.size() && end_of(moves[end]) - moves[begin].to <= voxels_on_their_way) ++end;
    gather_bricks<<<unsigned(end - begin), brick_threads, 0, heap_.stream()>>>(sent + begin, voxels(), layers_.data(),
                                                                               window);
    check_launch("gather_bricks");
    const std::size_t count = end_of(moves[end - 1]) - moves[begin].to;
    copy_on_device(window.surfaces, count, surfaces_.data() + moves[begin].to);
    copy_on_device(window.radiances, count, radiances_.data() + moves[begin].to);
  }
}

}  // namespace gigabake::kernels
