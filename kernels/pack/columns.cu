#include <algorithm>
#include <cub/device/device_scan.cuh>
#include <stdexcept>

#include "core/base/trace.h"
#include "kernels/body/prune/node.h"
#include "kernels/body/voxel.h"
#include "kernels/pack/columns.cuh"

namespace gigabake::kernels {
namespace {

constexpr unsigned threads = 256, warps = threads / 32, histogram_blocks = 64, axes = coverage_bytes;

/// The brick of a warp.
struct WarpBrick {
  int lod = -1;  ///< -1: the warp has no brick
  std::uint32_t brick, in_all;

  __device__ explicit WarpBrick(const LevelsView& levels) : in_all(blockIdx.x * warps + threadIdx.x / 32) {
    if (in_all >= levels.bricks_in_all) return;
    lod = levels.levels - 1;
    while (in_all < levels.offset[lod]) --lod;
    brick = in_all - levels.offset[lod];
  }
  __device__ const std::uint64_t* mask(const LevelsView& levels) const {
    return levels.mask[lod] + brick_edge * std::size_t(brick);
  }
  __device__ std::uint32_t first(const LevelsView& levels) const { return levels.first[lod][brick]; }
  __device__ std::uint32_t end(const LevelsView& levels) const { return levels.first[lod][brick + 1]; }
};

__device__ unsigned lane() { return threadIdx.x & 31; }
__device__ unsigned lower_lanes() { return (1u << lane()) - 1; }

struct NodesView {
  const std::uint32_t *key, *first_child, *value;
  const std::uint8_t *lod, *child_mask;
  const NodeKind* kind;  ///< null if all nodes are bricks, like `normal` and `directional_coverage`
  const std::uint16_t* normal;
  const std::uint32_t* directional_coverage;
  std::uint32_t count;
};

/// Writes the parent of each brick, one thread per node. The root's entry must be zero already.
__global__ void __launch_bounds__(threads)
    find_parents(const LevelsView levels, const NodesView nodes, BrickParent* parents) {
  const std::uint32_t n = blockIdx.x * threads + threadIdx.x;
  if (n >= nodes.count) return;
  const NodeKind kind = nodes.kind == nullptr ? NodeKind() : nodes.kind[n];
  BrickParent parent;
  parent.value = nodes.value[n];
  parent.normal = stores_voxels(kind) ? std::uint16_t(0) : nodes.normal[n];
  parent.kind = stores_voxels(kind) ? BrickParent::brick : BrickParent::constant;
  std::uint32_t child = nodes.first_child[n];
  for (unsigned octant = 0; octant < octants_a_brick; ++octant) {
    if ((nodes.child_mask[n] >> octant & 1) == 0) continue;
    parent.octant = std::uint8_t(octant);
    if (nodes.kind == nullptr || stores_voxels(nodes.kind[child]))
      parents[levels.offset[nodes.lod[child]] + nodes.value[child]] = parent;
    ++child;
  }
}

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

/// The parent brick of a warp's brick. Null if the parent is not a brick.
__device__ const std::uint64_t* mask_above(const LevelsView& levels, const WarpBrick& at, const BrickParent& parent) {
  return parent.kind == BrickParent::brick ? levels.mask[at.lod + 1] + brick_edge * std::size_t(parent.value) : nullptr;
}

/// Returns which groups have a parent voxel. `above` is the result of mask_above().
__device__ std::uint64_t groups_with_parent(const std::uint64_t* above, const BrickParent& parent) {
  if (above == nullptr) return parent.kind == BrickParent::constant ? ~std::uint64_t(0) : 0;
  return codes_of_octant(above, parent.octant);
}

__device__ std::uint8_t children_of(const std::uint64_t* mask, unsigned group) {
  return children_of_group(codes_of_octant(mask, group / 8), group);
}

__device__ const std::uint8_t* coverage_at(const LevelsView& levels, int lod, std::uint32_t voxel) {
  return levels.directional_coverage[lod] + directional_coverage_bytes * std::size_t(voxel);
}

/// Counts the rows of each brick, with one warp per brick.
__global__ void __launch_bounds__(threads)
    count_rows_of_bricks(const LevelsView levels, const BrickParent* parents, std::uint32_t* children,
                         std::uint32_t* coverage, Findings* findings) {
  const WarpBrick at(levels);
  if (at.lod < 0) return;
  const BrickParent parent = parents[at.in_all];
  const std::uint64_t there = groups_with_parent(mask_above(levels, at, parent), parent);
  bool is_orphan = false;
  for (unsigned group = lane(); group < groups_per_brick; group += 32)
    is_orphan |= (there >> group & 1) == 0 && children_of(at.mask(levels), group) != 0;
  const bool is_dense = __any_sync(~0u, parent.kind == BrickParent::brick && is_orphan);
  unsigned stored = 0;
  bool is_complete = false;
  if (levels.has_coverage[at.lod])
    for (std::uint32_t v = at.first(levels) + lane(); v < at.end(levels); v += 32) {
      const std::uint8_t* voxel = coverage_at(levels, at.lod, v);
      stored += stores_coverage(voxel[directional_coverage_plane], false) ? 1 : 0;
      is_complete |= requires_all_coverages(voxel);
    }
  stored = __reduce_add_sync(~0u, stored);
  is_complete = __any_sync(~0u, is_complete);
  if (lane() != 0) return;
  children[at.in_all] = children_rows(parent.kind, there, false);
  coverage[at.in_all] = stored;
  if (is_dense) findings->is_dense[at.lod] = 1;
  if (is_complete) findings->is_complete[at.lod] = 1;
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

/// Computes the rows before each level and the level's number of rows, one thread per level. The difference of two sums
/// is correct even if the 32-bit sums overflow.
__global__ void sum_levels(const LevelsView levels, const std::uint32_t* children, const std::uint32_t* coverage,
                           Findings* findings) {
  const unsigned lod = threadIdx.x;
  if (lod >= unsigned(levels.levels)) return;
  const std::uint32_t begin = levels.offset[lod], end = begin + levels.bricks[lod];
  findings->children_begin[lod] = children[begin];
  findings->children[lod] = children[end] - children[begin];
  findings->coverage_begin[lod] = coverage[begin];
  findings->coverage[lod] = coverage[end] - coverage[begin];
}

/// Writes the number of voxels before each word of a mask. All lanes of a warp must call this function.
__device__ void find_ranks(const std::uint64_t* mask, std::uint32_t* before) {
  std::uint32_t count = 0;
  for (unsigned z = 0; z < brick_edge; ++z) {
    if (lane() == z) before[z] = count;
    count += bits_in(mask[z]);
  }
  __syncwarp();
}

/// Returns `end` plus the sum of `count` over all lower lanes, and adds the sum over all lanes to `end`.
__device__ std::uint32_t place_after(std::uint32_t& end, std::uint32_t count) {
  std::uint32_t upto = count;
  for (unsigned d = 1; d < 32; d *= 2) {
    const std::uint32_t lower = __shfl_up_sync(~0u, upto, d);
    if (lane() >= d) upto += lower;
  }
  const std::uint32_t place = end + upto - count;
  end += __shfl_sync(~0u, upto, 31);
  return place;
}

/// The number of voxels before each word of the masks of a brick and of its parent.
struct Ranks {
  std::uint32_t own[brick_edge], above[brick_edge];
};

/// The prediction of a group.
struct Predicted {
  std::uint32_t rgb = 0;
  std::uint16_t normal = 0;
};

__device__ Predicted predict(const LevelsView& levels, const WarpBrick& at, const BrickParent& parent,
                             const std::uint64_t* above, std::uint64_t there, const Ranks& ranks, unsigned group) {
  if (parent.kind == BrickParent::constant) return {parent.value, parent.normal};
  if ((there >> group & 1) == 0) return {};
  const int lod = at.lod + 1;
  const std::uint32_t voxel = levels.first[lod][parent.value] +
                              rank_of(above, ranks.above, voxel_of_code(unsigned(parent.octant) << 6 | group));
  return {levels.rgba[lod][voxel], levels.normal[lod] == nullptr ? std::uint16_t(0) : levels.normal[lod][voxel]};
}

/// Writes the rows of a group's voxels in the columns of differences, from row `row` on.
__device__ void write_group(const LevelsView& levels, const WarpBrick& at, const Ranks& ranks, unsigned group,
                            std::uint32_t children, const Predicted& predicted, std::size_t row, const LevelOut& out) {
  for (unsigned child = 0; child < 8; ++child) {
    if ((children >> child & 1) == 0) continue;
    const std::uint32_t voxel =
        at.first(levels) + rank_of(at.mask(levels), ranks.own, voxel_of_code(group << 3 | child));
    if (out.rgb != nullptr) {
      const std::uint32_t colour = colour_difference(levels.rgba[at.lod][voxel], predicted.rgb);
      for (unsigned c = 0; c < 3; ++c) out.rgb[3 * row + c] = byte_of(colour, int(c));
    }
    if (out.normal != nullptr) {
      const std::uint16_t normal = normal_difference(levels.normal[at.lod][voxel], predicted.normal);
      out.normal[2 * row] = std::uint8_t(normal);
      out.normal[2 * row + 1] = std::uint8_t(normal >> 8);
    }
    ++row;
  }
}

/// Writes the columns `children`, `rgb` and `normal` of a brick.
__device__ void write_groups(const LevelsView& levels, const WarpBrick& at, const BrickParent& parent,
                             std::size_t children_row, const Ranks& ranks, const LevelOut& out) {
  const std::uint64_t* above = mask_above(levels, at, parent);
  const std::uint64_t there = groups_with_parent(above, parent);
  std::uint32_t row_end = at.first(levels), children_end = 0;
  for (unsigned group = lane(); group < groups_per_brick; group += 32) {
    const std::uint32_t children = children_of(at.mask(levels), group);
    const bool has_row = has_children_row(parent.kind, there, out.is_dense, group);
    const std::uint32_t own_row = place_after(children_end, has_row ? 1 : 0);
    if (has_row && out.children != nullptr) out.children[children_row + own_row] = std::uint8_t(children);
    const std::uint32_t row = place_after(row_end, bits_in(children));
    write_group(levels, at, ranks, group, children, predict(levels, at, parent, above, there, ranks, group), row, out);
  }
}

/// Writes the columns `alpha`, `plane` and `facing` of a brick. `row` is its first row in `facing`.
__device__ void write_voxels(const LevelsView& levels, const WarpBrick& at, std::size_t row, const LevelOut& out) {
  for (std::uint32_t first = at.first(levels); first < at.end(levels); first += 32) {
    const std::uint32_t v = first + lane();
    const bool is_there = v < at.end(levels);
    const std::uint8_t alpha = is_there ? byte_of(levels.rgba[at.lod][v], 3) : std::uint8_t(0);
    if (is_there && out.alpha != nullptr) out.alpha[v] = alpha;
    const std::uint8_t* voxel =
        is_there && (out.plane != nullptr || out.facing != nullptr) ? coverage_at(levels, at.lod, v) : nullptr;
    if (is_there && out.plane != nullptr) out.plane[v] = voxel[directional_coverage_plane];
    if (out.facing == nullptr) continue;
    const bool is_stored = is_there && stores_coverage(voxel[directional_coverage_plane], out.is_complete);
    const unsigned lanes = __ballot_sync(~0u, is_stored);
    if (is_stored) {
      const std::uint8_t predicted = predicted_coverage(voxel[directional_coverage_plane], alpha);
      for (unsigned axis = 0; axis < axes; ++axis)
        out.facing[coverage_bytes * (row + __popc(lanes & lower_lanes())) + axis] =
            std::uint8_t(voxel[axis] - predicted);
    }
    row += __popc(lanes);
  }
}

/// Writes a row of the column `first`: the rows before brick `brick`.
__device__ void write_start(const LevelsView& levels, int lod, std::uint32_t brick, const std::uint32_t* children,
                            const std::uint32_t* coverage, const LevelOut& out) {
  const std::uint32_t in_all = levels.offset[lod] + brick;
  std::uint64_t* row = out.first + 3 * std::size_t((brick + bricks_per_start - 1) / bricks_per_start);
  row[0] = levels.first[lod][brick];
  row[1] = out.is_dense ? groups_per_brick * std::uint64_t(brick) : children[in_all] - out.children_begin;
  row[2] = out.is_complete ? levels.first[lod][brick] : coverage[in_all] - out.coverage_begin;
}

/// Writes columns of all levels, with one warp per brick.
__global__ void __launch_bounds__(threads)
    write_columns(const LevelsView levels, const BrickParent* parents, const std::uint32_t* children,
                  const std::uint32_t* coverage, const LevelOut* outs) {
  __shared__ Ranks all_ranks[warps];
  const WarpBrick at(levels);
  if (at.lod < 0) return;
  const LevelOut& out = outs[at.lod];
  const BrickParent parent = parents[at.in_all];
  Ranks& ranks = all_ranks[threadIdx.x / 32];
  find_ranks(at.mask(levels), ranks.own);
  if (const std::uint64_t* above = mask_above(levels, at, parent); above != nullptr) find_ranks(above, ranks.above);
  const std::size_t children_row =
      out.is_dense ? groups_per_brick * std::size_t(at.brick) : std::uint32_t(children[at.in_all] - out.children_begin);
  if (out.children != nullptr || out.rgb != nullptr || out.normal != nullptr)
    write_groups(levels, at, parent, children_row, ranks, out);
  const std::size_t coverage_row =
      out.is_complete ? at.first(levels) : std::uint32_t(coverage[at.in_all] - out.coverage_begin);
  write_voxels(levels, at, coverage_row, out);
  if (out.first == nullptr) return;
  if (lane() == 0 && at.brick % bricks_per_start == 0) write_start(levels, at.lod, at.brick, children, coverage, out);
  if (lane() == 0 && at.brick + 1 == levels.bricks[at.lod])
    write_start(levels, at.lod, at.brick + 1, children, coverage, out);
}

NodesView view_of(const DeviceNodes& nodes) {
  return {nodes.key.data(),    nodes.first_child.data(),          nodes.value.data(),
          nodes.lod.data(),    nodes.child_mask.data(),           nodes.kind.data(),
          nodes.normal.data(), nodes.directional_coverage.data(), nodes.count};
}

bool has(const std::vector<LevelColumn>& columns, LevelColumn column) {
  return std::find(columns.begin(), columns.end(), column) != columns.end();
}

void expect_array(bool is_requested, bool is_empty) {
  if (is_requested && is_empty) throw std::invalid_argument("a column that the cell does not have");
}

}  // namespace

LevelsView view_of(const std::vector<const DeviceLevel*>& levels,
                   const std::vector<std::vector<LevelColumn>>& columns) {
  LevelsView view{};
  view.levels = int(levels.size());
  std::uint64_t bricks = 0;
  for (std::size_t l = 0; l < levels.size(); ++l) {
    const DeviceLevel& level = *levels[l];
    const bool has_normals = has(columns.at(l), LevelColumn::normal);
    view.has_coverage[l] = has(columns[l], LevelColumn::facing);
    const bool has_directions = view.has_coverage[l] || has(columns[l], LevelColumn::plane);
    expect_array(has_normals && level.voxels != 0, level.normal.empty());
    expect_array(has_directions && level.voxels != 0, level.directional_coverage.empty());
    view.mask[l] = level.mask.data();
    view.first[l] = level.first.data();
    view.rgba[l] = level.rgba.data();
    view.normal[l] = has_normals ? level.normal.data() : nullptr;
    view.directional_coverage[l] = has_directions ? level.directional_coverage.data() : nullptr;
    view.bricks[l] = level.bricks;
    view.voxels[l] = level.voxels;
    view.offset[l] = std::uint32_t(bricks);
    bricks += level.bricks;
  }
  if (bricks >> 32 != 0) throw std::length_error("more than 2^32-1 bricks");
  view.bricks_in_all = std::uint32_t(bricks);
  return view;
}

std::uint64_t Findings::rows(const LevelsView& levels, LevelColumn column, int lod) const {
  const std::uint64_t bricks = levels.bricks[lod];
  switch (column) {
    case LevelColumn::first:
      return (bricks + bricks_per_start - 1) / bricks_per_start + 1;
    case LevelColumn::children:
      return is_dense[lod] != 0 ? groups_per_brick * bricks : children[lod];
    case LevelColumn::facing:
      return is_complete[lod] != 0 ? levels.voxels[lod] : coverage[lod];
    default:
      return levels.voxels[lod];
  }
}

BrickRows count_rows(DeviceHeap& heap, const LevelsView& levels, const DeviceNodes& nodes, Findings& findings) {
  const TraceSpan span("count rows");
  const std::size_t items = levels.bricks_in_all;
  BrickRows out{DeviceArray<BrickParent>(heap, items), DeviceArray<std::uint32_t>(heap, items + 1),
                DeviceArray<std::uint32_t>(heap, items + 1)};
  DeviceArray<std::uint32_t> children(heap, items + 1), coverage(heap, items + 1);
  DeviceArray<Findings> found(heap, 1);
  out.parent.clear_to_zero();
  children.clear_to_zero();
  coverage.clear_to_zero();
  found.clear_to_zero();
  find_parents<<<grid_of(nodes.count, threads), threads, 0, heap.stream()>>>(levels, view_of(nodes), out.parent.data());
  check_launch("find_parents");
  count_rows_of_bricks<<<grid_of(levels.bricks_in_all, warps), threads, 0, heap.stream()>>>(
      levels, out.parent.data(), children.data(), coverage.data(), found.data());
  check_launch("count_rows_of_bricks");
  count_alphas<<<dim3(histogram_blocks, unsigned(levels.levels)), threads, 0, heap.stream()>>>(levels, found.data());
  check_launch("count_alphas");
  for (const auto& [counts, before] :
       {std::pair{children.data(), out.children.data()}, std::pair{coverage.data(), out.coverage.data()}})
    with_temporary(heap, [&](void* temporary, std::size_t& bytes) {
      check_cuda(cub::DeviceScan::ExclusiveSum(temporary, bytes, counts, before, items + 1, heap.stream()),
                 "DeviceScan (rows)");
    });
  sum_levels<<<1, 32, 0, heap.stream()>>>(levels, out.children.data(), out.coverage.data(), found.data());
  check_launch("sum_levels");
  heap.bring(&findings, found.data(), sizeof findings, "rows of columns");
  return out;
}

void make_columns(DeviceHeap& heap, const LevelsView& levels, const BrickRows& rows, const std::vector<LevelOut>& out) {
  DeviceArray<LevelOut> places(heap, out.size());
  upload_async(places.data(), out.data(), places.bytes(), heap.stream(), "cudaMemcpyAsync (columns)");
  write_columns<<<grid_of(levels.bricks_in_all, warps), threads, 0, heap.stream()>>>(
      levels, rows.parent.data(), rows.children.data(), rows.coverage.data(), places.data());
  check_launch("write_columns");
}

void make_node_columns(DeviceHeap& heap, const DeviceNodes& nodes, const NodesOut& out) {
  write_nodes<<<grid_of(nodes.count, threads), threads, 0, heap.stream()>>>(view_of(nodes), out);
  check_launch("write_nodes");
}

}  // namespace gigabake::kernels
