#include <cub/device/device_scan.cuh>

#include "kernels/cuda/prune/node_levels.cuh"
#include "kernels/cuda/prune/prune.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 256, warps = threads / 32;

/// The voxel arrays of all levels, by lod.
struct PrunedVoxels {
  const std::uint32_t* rgba[max_levels];
  const std::uint16_t* normal[max_levels];               ///< null if the level has none
  const std::uint8_t* directional_coverage[max_levels];  ///< null if the level has none

  __device__ CommonVoxel at(int lod, std::uint32_t voxel) const {
    return common_voxel(rgba[lod][voxel], normal[lod] == nullptr ? std::uint16_t(0) : normal[lod][voxel],
                        directional_coverage[lod] == nullptr
                            ? nullptr
                            : directional_coverage[lod] + directional_coverage_bytes * std::size_t(voxel));
  }
};

/// Classification of each item. is_stored and has_voxels have one more element, a zero, for their prefix sums.
struct Verdicts {
  NodeKind* kind;
  CommonVoxel* voxel;  ///< the brick's first voxel
  std::uint32_t *is_stored, *has_voxels;
};

/// Prefix sums: the stored nodes before each item, and the bricks before it that keep their voxels.
struct Numbers {
  const std::uint32_t *node, *brick;

  __device__ std::uint32_t in_level(const NodeLevels& levels, int lod, std::uint32_t item) const {
    return brick[item] - brick[levels.offset[lod]];
  }
};

/// Classifies one brick per warp.
__global__ void __launch_bounds__(threads)
    classify_bricks(const NodeLevels levels, const PrunedVoxels voxels, std::uint32_t items, Verdicts out) {
  const std::uint32_t item = blockIdx.x * warps + threadIdx.x / 32, lane = threadIdx.x % 32;
  if (item >= items) return;
  const int lod = levels.lod_of(item);
  const std::uint32_t* first = levels.first[lod] + (item - levels.offset[lod]);
  const CommonVoxel own = voxels.at(lod, *first);
  bool is_constant = is_full(first);
  for (std::uint32_t i = lane; is_constant && i < std::uint32_t(brick_voxels); i += 32)
    is_constant = are_equal(own, voxels.at(lod, *first + i));
  const NodeKind kind = kind_of_brick(__all_sync(~0u, is_constant));
  if (lane != 0) return;
  out.kind[item] = kind;
  out.voxel[item] = own;
  out.is_stored[item] = 1;
  out.has_voxels[item] = stores_voxels(kind) ? 1 : 0;
}

/// Replaces constant branches by one node, one thread per brick of level `lod`. The next finer level must have been
/// processed.
__global__ void __launch_bounds__(threads) end_branches(const NodeLevels levels, int lod, Verdicts out) {
  const std::uint32_t brick = blockIdx.x * threads + threadIdx.x;
  if (brick >= levels.bricks[lod]) return;
  const std::uint32_t item = levels.offset[lod] + brick, key = levels.key[lod][brick];
  if (stores_voxels(out.kind[item])) return;
  int like_it = 0;
  levels.for_each_child(lod, key, [&](std::uint32_t child, std::uint32_t) {
    like_it += ends_branch(out.kind[child]) && are_equal(out.voxel[child], out.voxel[item]) ? 1 : 0;
  });
  const NodeKind kind = kind_of_constant(lod == 0 || like_it == 8);
  out.kind[item] = kind;
  if (!ends_branch(kind)) return;
  levels.for_each_child(lod, key, [&](std::uint32_t child, std::uint32_t) { out.is_stored[child] = 0; });
}

/// Writes the number of bricks of each level that keep their voxels, one thread per level, and the number of all nodes.
__global__ void count_kept(const NodeLevels levels, Numbers numbers, std::uint32_t items, std::uint32_t* kept) {
  const int lod = int(threadIdx.x);
  if (lod < levels.count) kept[lod] = numbers.in_level(levels, lod, levels.offset[lod] + levels.bricks[lod]);
  if (lod == 0) kept[levels.count] = numbers.node[items];
}

struct NodeRows {
  std::uint32_t *key, *first_child, *value, *directional_coverage;
  std::uint16_t* normal;
  std::uint8_t *lod, *child_mask;
  NodeKind* kind;
};

/// Makes the node of one item per thread.
__global__ void __launch_bounds__(threads)
    make_pruned_nodes(const NodeLevels levels, const PrunedVoxels voxels, Verdicts verdicts, Numbers numbers,
                      std::uint32_t items, NodeRows out) {
  const std::uint32_t item = blockIdx.x * threads + threadIdx.x;
  if (item >= items || verdicts.is_stored[item] == 0) return;
  const int lod = levels.lod_of(item);
  const std::uint32_t row = numbers.node[item], key = levels.key[lod][item - levels.offset[lod]];
  const NodeKind kind = verdicts.kind[item];
  const CommonVoxel value = value_of_node(kind, verdicts.voxel[item], voxels.directional_coverage[lod] != nullptr);
  NodeChildren children;
  if (!ends_branch(kind))
    levels.for_each_child(
        lod, key, [&](std::uint32_t child, std::uint32_t child_key) { children.add(numbers.node[child], child_key); });
  out.key[row] = key;
  out.lod[row] = std::uint8_t(lod);
  out.kind[row] = kind;
  out.child_mask[row] = children.mask;
  out.first_child[row] = children.first;
  out.value[row] = stores_voxels(kind) ? numbers.in_level(levels, lod, item) : value.rgba;
  out.normal[row] = value.normal;
  out.directional_coverage[row] = value.directional_coverage;
}

struct KeptOut {
  std::uint32_t *key, *first, *rgba;
  std::uint64_t* mask;
  std::uint16_t* normal;                ///< null if the level has none
  std::uint32_t* directional_coverage;  ///< null if the level has none
};

/// Copies the bricks that keep their voxels to consecutive places, one warp per brick of the level.
__global__ void __launch_bounds__(threads)
    keep_bricks(const NodeLevels levels, const PrunedVoxels voxels, const std::uint64_t* mask, int lod,
                Verdicts verdicts, Numbers numbers, KeptOut out) {
  const std::uint32_t brick = blockIdx.x * warps + threadIdx.x / 32, lane = threadIdx.x % 32;
  if (brick >= levels.bricks[lod]) return;
  const std::uint32_t item = levels.offset[lod] + brick;
  if (verdicts.has_voxels[item] == 0) return;
  const std::uint32_t to = numbers.in_level(levels, lod, item), first = levels.first[lod][brick],
                      end = levels.first[lod][brick + 1], gone = (brick - to) * std::uint32_t(brick_voxels);
  if (lane < 8) out.mask[8 * std::size_t(to) + lane] = mask[8 * std::size_t(brick) + lane];
  if (lane == 0) {
    out.key[to] = levels.key[lod][brick];
    out.first[to + 1] = end - gone;
  }
  const auto* directional_coverage = reinterpret_cast<const std::uint32_t*>(voxels.directional_coverage[lod]);
  for (std::uint32_t i = first + lane; i < end; i += 32) {
    out.rgba[i - gone] = voxels.rgba[lod][i];
    if (out.normal != nullptr) out.normal[i - gone] = voxels.normal[lod][i];
    if (out.directional_coverage != nullptr) out.directional_coverage[i - gone] = directional_coverage[i];
  }
}

PrunedVoxels voxels_of(const std::vector<DeviceLevel>& levels) {
  static_assert(directional_coverage_bytes == sizeof(std::uint32_t));
  PrunedVoxels view{};
  for (std::size_t l = 0; l < levels.size(); ++l) {
    view.rgba[l] = levels[l].rgba.data();
    view.normal[l] = levels[l].normal.empty() ? nullptr : levels[l].normal.data();
    view.directional_coverage[l] =
        levels[l].directional_coverage.empty() ? nullptr : levels[l].directional_coverage.data();
  }
  return view;
}

void add_up(DeviceHeap& heap, const std::uint32_t* ones, std::uint32_t* before, std::uint32_t items) {
  with_temporary(heap, [&](void* temporary, std::size_t& bytes) {
    check_cuda(cub::DeviceScan::ExclusiveSum(temporary, bytes, ones, before, items, heap.stream()),
               "DeviceScan (nodes)");
  });
}

NodeRows make_rows(DeviceHeap& heap, std::uint32_t count, DeviceNodes& nodes) {
  nodes = make_device_nodes(heap, count);
  nodes.kind = DeviceArray<NodeKind>(heap, count);
  nodes.normal = DeviceArray<std::uint16_t>(heap, count);
  nodes.directional_coverage = DeviceArray<std::uint32_t>(heap, count);
  return {nodes.key.data(),    nodes.first_child.data(), nodes.value.data(),      nodes.directional_coverage.data(),
          nodes.normal.data(), nodes.lod.data(),         nodes.child_mask.data(), nodes.kind.data()};
}

/// Allocates the arrays of the bricks and voxels that are kept.
KeptOut make_kept(DeviceHeap& heap, const DeviceLevel& level, std::uint32_t bricks, DeviceLevel& out) {
  out.bricks = bricks;
  out.voxels = level.voxels - (level.bricks - bricks) * std::uint32_t(brick_voxels);
  out.key = DeviceArray<std::uint32_t>(heap, bricks);
  out.first = DeviceArray<std::uint32_t>(heap, std::size_t(bricks) + 1);
  out.first.clear_to_zero();
  out.mask = DeviceArray<std::uint64_t>(heap, 8 * std::size_t(bricks));
  out.rgba = DeviceArray<std::uint32_t>(heap, out.voxels);
  if (!level.normal.empty()) out.normal = DeviceArray<std::uint16_t>(heap, out.voxels);
  if (!level.directional_coverage.empty())
    out.directional_coverage = DeviceArray<std::uint8_t>(heap, directional_coverage_bytes * std::size_t(out.voxels));
  return {
      out.key.data(),
      out.first.data(),
      out.rgba.data(),
      out.mask.data(),
      level.normal.empty() ? nullptr : out.normal.data(),
      level.directional_coverage.empty() ? nullptr : reinterpret_cast<std::uint32_t*>(out.directional_coverage.data())};
}

}  // namespace

PrunedLevels prune_levels(DeviceHeap& heap, const std::vector<DeviceLevel>& levels) {
  NodeLevels placed{};
  const std::uint32_t items = place_levels(levels, placed);
  const PrunedVoxels voxels = voxels_of(levels);
  DeviceArray<NodeKind> kind(heap, items);
  DeviceArray<CommonVoxel> voxel(heap, items);
  DeviceArray<std::uint32_t> is_stored(heap, items + 1), has_voxels(heap, items + 1), node(heap, items + 1),
      brick(heap, items + 1), counts(heap, levels.size() + 1);
  is_stored.clear_to_zero();
  has_voxels.clear_to_zero();
  const Verdicts verdicts{kind.data(), voxel.data(), is_stored.data(), has_voxels.data()};
  classify_bricks<<<grid_of(items, warps), threads, 0, heap.stream()>>>(placed, voxels, items, verdicts);
  check_launch("judge_bricks");
  for (int lod = 0; lod < placed.count; ++lod) {
    end_branches<<<grid_of(placed.bricks[lod], threads), threads, 0, heap.stream()>>>(placed, lod, verdicts);
    check_launch("end_branches");
  }
  add_up(heap, is_stored.data(), node.data(), items + 1);
  add_up(heap, has_voxels.data(), brick.data(), items + 1);
  const Numbers numbers{node.data(), brick.data()};
  count_kept<<<1, 32, 0, heap.stream()>>>(placed, numbers, items, counts.data());
  check_launch("count_kept");
  std::vector<std::uint32_t> kept(levels.size() + 1);
  heap.bring(kept.data(), counts.data(), counts.bytes(), "constant bricks");

  PrunedLevels out;
  make_pruned_nodes<<<grid_of(items, threads), threads, 0, heap.stream()>>>(placed, voxels, verdicts, numbers, items,
                                                                            make_rows(heap, kept.back(), out.nodes));
  check_launch("make_pruned_nodes");
  for (std::size_t lod = 0; lod < levels.size(); ++lod) {
    out.levels.push_back(&levels[lod]);
    if (kept[lod] == levels[lod].bricks) continue;
    out.has_constants = true;
    DeviceLevel& made = out.made.emplace_back();
    const KeptOut to = make_kept(heap, levels[lod], kept[lod], made);
    keep_bricks<<<grid_of(levels[lod].bricks, warps), threads, 0, heap.stream()>>>(
        placed, voxels, levels[lod].mask.data(), int(lod), verdicts, numbers, to);
    check_launch("keep_bricks");
    out.levels.back() = &made;
  }
  return out;
}

}  // namespace gigabake::kernels
