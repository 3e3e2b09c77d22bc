#include <algorithm>
#include <cub/device/device_scan.cuh>
#include <stdexcept>

#include "core/base/trace.h"
#include "kernels/body/voxel.h"
#include "kernels/pack/columns.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 256, warps = threads / 32, histogram_blocks = 64;

__device__ std::uint64_t warp_or(std::uint64_t bits) {
  return std::uint64_t(__reduce_or_sync(~0u, unsigned(bits >> 32))) << 32 | __reduce_or_sync(~0u, unsigned(bits));
}

__device__ unsigned lower_lanes() { return (1u << (threadIdx.x & 31)) - 1; }

/// The brick and channel of a warp; blockIdx.y is the channel.
struct WarpBrick {
  int lod = -1;  ///< -1: the warp has no brick
  std::uint32_t brick;
  std::size_t number;  ///< index of the entry in FoundShares

  __device__ explicit WarpBrick(const LevelsView& levels) {
    const std::uint32_t in_all = blockIdx.x * warps + threadIdx.x / 32;
    if (in_all >= levels.bricks_in_all) return;
    lod = levels.levels - 1;
    while (in_all < levels.offset[lod]) --lod;
    brick = in_all - levels.offset[lod];
    number = std::size_t(blockIdx.y) * levels.bricks_in_all + in_all;
  }
};

/// The voxel of one lane. The lanes of a warp process 32 consecutive positions of a brick. `place` is the voxel's
/// position in the brick, and `number` its index in the level.
struct LaneVoxel {
  bool is_there;
  unsigned place, lanes;  ///< lanes: mask of the lanes that have a voxel
  std::uint32_t number;
};

/// Calls visit(LaneVoxel) for all voxels of a brick, in order. All lanes of a warp must call this function.
template <class Visit>
__device__ void for_each_voxels(const std::uint64_t* mask, std::uint32_t first, const Visit& visit) {
  const unsigned lane = threadIdx.x & 31;
  const std::uint32_t own = lane < 16 ? reinterpret_cast<const std::uint32_t*>(mask)[lane] : 0;
  for (unsigned w = 0; w < 16; ++w) {
    const std::uint32_t lanes = __shfl_sync(~0u, own, int(w));
    if (lanes == 0) continue;
    visit(LaneVoxel{(lanes >> lane & 1) != 0, 32 * w + lane, lanes, first + __popc(lanes & lower_lanes())});
    first += __popc(lanes);
  }
}

__device__ const std::uint8_t* bytes_of(const ChannelView& channel, std::uint32_t voxel) {
  return channel.bytes + std::size_t(voxel) * channel.stride;
}

/// Returns true if no lower lane of `lanes` has the same key. All lanes of the mask `lanes` must call this function.
__device__ bool is_lowest(unsigned lanes, unsigned key) { return (__match_any_sync(lanes, key) & lower_lanes()) == 0; }

/// Writes the value of each group's first voxel to `value`. Returns a mask of the groups that have voxels.
__device__ std::uint64_t find_groups(const LevelsView& levels, const WarpBrick& at, const ChannelView& channel,
                                     std::uint32_t* value) {
  std::uint64_t seen = 0;
  for_each_voxels(levels.mask[at.lod] + 8 * std::size_t(at.brick), levels.first[at.lod][at.brick],
                  [&](const LaneVoxel& v) {
                    const unsigned group = group_of(v.place);
                    if (v.is_there && is_lowest(v.lanes, group) && (seen >> group & 1) == 0)
                      value[group] = value_at(bytes_of(channel, v.number), channel.width);
                    seen |= warp_or(v.is_there ? std::uint64_t(1) << group : 0);
                  });
  return seen;
}

/// Determines the values that the voxels of each brick share, with one warp per brick and channel.
__global__ void __launch_bounds__(threads)
    share_bricks(const LevelsView levels, std::uint8_t* share, std::uint32_t* values, Findings* findings) {
  __shared__ std::uint32_t first_value[warps][groups_per_brick];
  const WarpBrick at(levels);
  if (at.lod < 0) return;
  const ChannelView channel = levels.channel[at.lod][blockIdx.y];
  if (channel.bytes == nullptr) return;
  std::uint32_t* value = first_value[threadIdx.x / 32];
  const std::uint64_t seen = find_groups(levels, at, channel, value);
  __syncwarp();
  const std::uint64_t* mask = levels.mask[at.lod] + 8 * std::size_t(at.brick);
  const std::uint32_t first = levels.first[at.lod][at.brick], levels_value = value_at(channel.bytes, channel.width);
  std::uint64_t mixed = 0;
  bool differs = false;
  for_each_voxels(mask, first, [&](const LaneVoxel& v) {
    if (!v.is_there) return;
    const std::uint32_t own = value_at(bytes_of(channel, v.number), channel.width);
    const unsigned group = group_of(v.place);
    mixed |= std::uint64_t(own != value[group]) << group;
    differs |= own != levels_value;
  });
  mixed = warp_or(mixed);
  unsigned mixed_voxels = 0;
  if (mixed != 0)
    for_each_voxels(mask, first, [&](const LaneVoxel& v) {
      mixed_voxels += unsigned(v.is_there) & unsigned(mixed >> group_of(v.place));
    });
  mixed_voxels = __reduce_add_sync(~0u, mixed_voxels);
  const bool any_differs = __any_sync(~0u, differs);
  if ((threadIdx.x & 31) != 0) return;
  values[at.number] = share_brick({value, seen, mixed}, mixed_voxels, share + share_bytes * at.number);
  if (any_differs) findings->differ[blockIdx.y][at.lod] = 1;
}

/// Counts alphas; blockIdx.y is the level.
__global__ void __launch_bounds__(threads) count_alphas(const LevelsView levels, Findings* findings) {
  __shared__ unsigned counts[threads];
  const int lod = int(blockIdx.y);
  counts[threadIdx.x] = 0;
  __syncthreads();
  for (std::uint32_t i = blockIdx.x * threads + threadIdx.x; i < levels.voxels[lod]; i += gridDim.x * threads)
    atomicAdd(&counts[byte_of(levels.rgba[lod][i], 3)], 1u);
  __syncthreads();
  if (counts[threadIdx.x] != 0)
    atomicAdd(&findings->alphas[lod][threadIdx.x], (unsigned long long)(counts[threadIdx.x]));
}

/// Computes the index of each level's first value and the number of values. There is one thread per level; blockIdx.y
/// is the channel. The difference of two sums is correct even if the 32-bit sums overflow.
__global__ void sum_levels(const LevelsView levels, const std::uint32_t* start, Findings* findings) {
  const unsigned lod = threadIdx.x;
  if (lod >= unsigned(levels.levels)) return;
  const std::uint32_t* first = start + std::size_t(blockIdx.y) * levels.bricks_in_all + levels.offset[lod];
  findings->begin[blockIdx.y][lod] = first[0];
  findings->values[blockIdx.y][lod] = first[levels.bricks[lod]] - first[0];
}

__device__ void write_value(const ChannelView& channel, std::uint32_t voxel, std::uint8_t* column, std::uint32_t row) {
  const std::uint8_t* from = bytes_of(channel, voxel);
  for (std::uint32_t i = 0; i < channel.width; ++i) column[std::size_t(row) * channel.width + i] = from[i];
}

/// Writes the stored values of a brick in the order of voxels. Voxels of mixed groups store separate values. Groups
/// that share a value store it once.
__device__ void write_shared(const LevelsView& levels, const WarpBrick& at, const std::uint8_t* share,
                             std::uint32_t row, std::uint8_t* column) {
  const ChannelView channel = levels.channel[at.lod][blockIdx.y];
  const ValueLeaders leaders(share);
  std::uint64_t led = 0;
  for_each_voxels(levels.mask[at.lod] + 8 * std::size_t(at.brick), levels.first[at.lod][at.brick],
                  [&](const LaneVoxel& v) {
                    const unsigned group = group_of(v.place), leader = leaders.leader(group), lane = threadIdx.x & 31;
                    const bool is_first =
                        v.is_there && is_lowest(v.lanes, leaders.are_one(group) ? leader : groups_per_brick + lane);
                    const bool is_new = is_first && leaders.is_new(group, led);
                    const unsigned lanes = __ballot_sync(~0u, is_new);
                    if (is_new) write_value(channel, v.number, column, row + __popc(lanes & lower_lanes()));
                    row += __popc(lanes);
                    led |= warp_or(v.is_there ? std::uint64_t(1) << leader : 0);
                  });
}

__device__ void write_brick(const LevelsView& levels, const WarpBrick& at, const LevelOut& out) {
  const unsigned lane = threadIdx.x & 31;
  const std::size_t row = 8 * std::size_t(at.brick) + lane;
  if (lane < 8) out.mask[row] = levels.mask[at.lod][row];
  if (lane == 0) out.first[at.brick] = levels.first[at.lod][at.brick];
  if (lane == 0 && at.brick + 1 == levels.bricks[at.lod]) out.first[at.brick + 1] = levels.voxels[at.lod];
}

__device__ void write_channel(const LevelsView& levels, const WarpBrick& at, const std::uint8_t* share,
                              const std::uint32_t* start, const LevelOut::Channel& out) {
  const unsigned lane = threadIdx.x & 31;
  const ChannelView channel = levels.channel[at.lod][blockIdx.y];
  if (out.stored == ValuesStored::one) {
    if (at.brick == 0 && lane == 0) write_value(channel, 0, out.value, 0);
  } else if (out.stored == ValuesStored::plain) {
    const std::uint32_t end = levels.first[at.lod][at.brick + 1];
    for (std::uint32_t i = levels.first[at.lod][at.brick] + lane; i < end; i += 32)
      write_value(channel, i, out.value, i);
  } else {
    const std::uint8_t* own = share + share_bytes * at.number;
    const std::uint32_t row = start[at.number] - out.begin;
    if (lane < share_bytes) out.share[share_bytes * std::size_t(at.brick) + lane] = own[lane];
    if (lane == 0) out.first[at.brick] = row;
    if (lane == 0 && at.brick + 1 == levels.bricks[at.lod])
      out.first[at.brick + 1] = std::uint32_t(start[at.number + 1] - out.begin);
    write_shared(levels, at, own, row, out.value);
  }
}

/// Writes all columns of all levels, with one warp per brick and channel. blockIdx.y is the channel. The blockIdx.y
/// after the last channel is for the columns `mask` and `first`.
__global__ void __launch_bounds__(threads)
    write_columns(const LevelsView levels, const std::uint8_t* share, const std::uint32_t* start, const LevelOut* out) {
  const WarpBrick at(levels);
  if (at.lod < 0) return;
  if (int(blockIdx.y) == levels.channels) return write_brick(levels, at, out[at.lod]);
  if (levels.channel[at.lod][blockIdx.y].bytes != nullptr)
    write_channel(levels, at, share, start, out[at.lod].channel[blockIdx.y]);
}

struct NodesView {
  const std::uint32_t *key, *first_child, *value;
  const std::uint8_t *lod, *child_mask;
  const NodeKind* kind;  ///< null if all nodes are bricks, like `normal` and `directional_coverage`
  const std::uint16_t* normal;
  const std::uint32_t* directional_coverage;
  std::uint32_t count;
};

__global__ void __launch_bounds__(threads) write_nodes(const NodesView nodes, const NodesOut out) {
  const std::uint32_t n = blockIdx.x * threads + threadIdx.x;
  if (n >= nodes.count) return;
  out.key[n] = nodes.key[n];
  out.first_child[n] = nodes.first_child[n];
  out.value[n] = nodes.value[n];
  out.lod[n] = nodes.lod[n];
  out.child_mask[n] = nodes.child_mask[n];
  if (nodes.kind == nullptr) return;
  out.kind[n] = nodes.kind[n];
  out.normal[n] = nodes.normal[n];
  if (out.directional_coverage != nullptr) out.directional_coverage[n] = nodes.directional_coverage[n];
}

ChannelView view_of_channel(const DeviceLevel& level, const ChannelPlace& place) {
  const auto view = [&](const auto& array) {
    if (array.empty()) throw std::invalid_argument("a channel that the cell does not have");
    return ChannelView{reinterpret_cast<const std::uint8_t*>(array.data()) + place.offset, std::uint32_t(place.stride),
                       std::uint32_t(place.width)};
  };
  switch (place.array) {
    case VoxelArray::rgba:
      return view(level.rgba);
    case VoxelArray::normal:
      return view(level.normal);
    default:
      return view(level.directional_coverage);
  }
}

}  // namespace

LevelsView view_of(const std::vector<const DeviceLevel*>& levels,
                   const std::vector<std::vector<ChannelPlace>>& channels) {
  LevelsView view{};
  view.levels = int(levels.size());
  std::uint64_t bricks = 0;
  for (std::size_t l = 0; l < levels.size(); ++l) {
    const DeviceLevel& level = *levels[l];
    view.mask[l] = level.mask.data();
    view.first[l] = level.first.data();
    view.rgba[l] = level.rgba.data();
    view.bricks[l] = level.bricks;
    view.voxels[l] = level.voxels;
    view.offset[l] = std::uint32_t(bricks);
    bricks += level.bricks;
    if (channels.at(l).size() > std::size_t(max_channels)) throw std::length_error("more channels than are packed");
    for (std::size_t c = 0; level.voxels != 0 && c < channels[l].size(); ++c)
      view.channel[l][c] = view_of_channel(level, channels[l][c]);
    view.channels = std::max(view.channels, int(channels[l].size()));
  }
  if (bricks >> 32 != 0) throw std::length_error("more than 2^32-1 bricks");
  view.bricks_in_all = std::uint32_t(bricks);
  return view;
}

ValuesStored Findings::stored(const LevelsView& levels, int channel, int lod) const {
  return how_stored(levels.voxels[lod], differ[channel][lod] == 0, values[channel][lod], levels.bricks[lod],
                    levels.channel[lod][channel].width);
}

FoundShares find_shares(DeviceHeap& heap, const LevelsView& levels, Findings& findings) {
  const TraceSpan span("find shared values");
  const std::size_t items = std::size_t(levels.channels) * levels.bricks_in_all;
  FoundShares out{DeviceArray<std::uint8_t>(heap, share_bytes * items), DeviceArray<std::uint32_t>(heap, items + 1)};
  DeviceArray<std::uint32_t> values(heap, items + 1);
  DeviceArray<Findings> found(heap, 1);
  values.clear_to_zero();
  found.clear_to_zero();
  const dim3 grid(grid_of(levels.bricks_in_all, warps), unsigned(levels.channels));
  share_bricks<<<grid, threads, 0, heap.stream()>>>(levels, out.share.data(), values.data(), found.data());
  check_launch("share_bricks");
  count_alphas<<<dim3(histogram_blocks, unsigned(levels.levels)), threads, 0, heap.stream()>>>(levels, found.data());
  check_launch("count_alphas");
  with_temporary(heap, [&](void* temporary, std::size_t& bytes) {
    check_cuda(
        cub::DeviceScan::ExclusiveSum(temporary, bytes, values.data(), out.start.data(), items + 1, heap.stream()),
        "DeviceScan (shared values)");
  });
  sum_levels<<<dim3(1, unsigned(levels.channels)), 32, 0, heap.stream()>>>(levels, out.start.data(), found.data());
  check_launch("sum_levels");
  heap.bring(&findings, found.data(), sizeof findings, "shared values");
  return out;
}

void make_columns(DeviceHeap& heap, const LevelsView& levels, const FoundShares& shares,
                  const std::vector<LevelOut>& out) {
  DeviceArray<LevelOut> places(heap, out.size());
  upload_async(places.data(), out.data(), places.bytes(), heap.stream(), "cudaMemcpyAsync (columns)");
  const dim3 grid(grid_of(levels.bricks_in_all, warps), unsigned(levels.channels) + 1);
  write_columns<<<grid, threads, 0, heap.stream()>>>(levels, shares.share.data(), shares.start.data(), places.data());
  check_launch("write_columns");
}

void make_node_columns(DeviceHeap& heap, const DeviceNodes& nodes, const NodesOut& out) {
  write_nodes<<<grid_of(nodes.count, threads), threads, 0, heap.stream()>>>(
      {nodes.key.data(), nodes.first_child.data(), nodes.value.data(), nodes.lod.data(), nodes.child_mask.data(),
       nodes.kind.data(), nodes.normal.data(), nodes.directional_coverage.data(), nodes.count},
      out);
  check_launch("write_nodes");
}

}  // namespace gigabake::kernels
