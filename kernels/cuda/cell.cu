#include <algorithm>
#include <span>

#include "core/base/trace.h"
#include "kernels/body/mip/mip.h"
#include "kernels/cpu/mip/downsample_state.h"
#include "kernels/cpu/mip/level_hash.h"
#include "kernels/cpu/mip/levels.h"
#include "kernels/cuda/cell.cuh"
#include "kernels/cuda/device/download.cuh"
#include "kernels/cuda/edit.cuh"
#include "kernels/cuda/mip/hash.cuh"
#include "kernels/cuda/voxelize/quantize_groups.cuh"

namespace gigabake::kernels {
namespace {

/// Units are the nodes `levels_above_units` levels below the root. They are at least `min_unit_level` levels above the
/// bricks, because a launch for a small unit is not worth its cost.
constexpr int levels_above_units = 5, min_unit_level = 2;
constexpr double live_share = 1.2;  ///< intended live bytes, as a multiple of the expected bytes of input and output

std::uint64_t limit_of(std::uint64_t memory_bytes, std::uint64_t input_bytes) {
  if (memory_bytes == 0) return 0;
  return std::max({memory_bytes - std::min(memory_bytes, input_bytes), memory_bytes / 4, std::uint64_t(1)});
}

void append(Level& to, const Level& from) {
  const std::uint64_t voxels = to.first.empty() ? 0 : to.first.back();
  if (to.first.empty()) to.first.push_back(0);
  to.key.insert(to.key.end(), from.key.begin(), from.key.end());
  to.mask.insert(to.mask.end(), from.mask.begin(), from.mask.end());
  for (std::size_t b = 1; b < from.first.size(); ++b) to.first.push_back(voxels + from.first[b]);
  to.rgba.insert(to.rgba.end(), from.rgba.begin(), from.rgba.end());
  to.normal.insert(to.normal.end(), from.normal.begin(), from.normal.end());
  to.directional_coverage.insert(to.directional_coverage.end(), from.directional_coverage.begin(),
                                 from.directional_coverage.end());
}

template <class T>
void append(const DeviceArray<T>& from, std::vector<T>& to) {
  const std::size_t before = to.size();
  to.resize(before + from.size());
  if (from.empty()) return;
  count_work(WorkCounter::device_bytes_downloaded, from.bytes());
  count_work(WorkCounter::device_synchronizations);
  check_cuda(cudaMemcpy(to.data() + before, from.data(), from.bytes(), cudaMemcpyDeviceToHost),
             "cudaMemcpy (input of coarser levels)");
}

}  // namespace

/// Data that all parts of a cell share.
struct CellBake::Cell {
  InputView input;
  CellWindow window;
  const CellParameters& parameters;
  CellMaterials materials;
  std::uint64_t limit;  ///< max live bytes of the heap
  std::uint64_t room;   ///< intended live bytes of the heap
};

/// The octree nodes that a cell can be split into, and the pairs before each of them.
struct CellBake::Units {
  int level;                                      ///< number of levels above the bricks
  std::vector<std::uint64_t> pairs_before{0};     ///< of triangles and bricks
  std::vector<std::uint64_t> contents_before{0};  ///< pairs, and voxels that edits fill

  void push_back(std::uint64_t pairs, std::uint64_t filled_voxels) {
    pairs_before.push_back(pairs_before.back() + pairs);
    contents_before.push_back(contents_before.back() + pairs + filled_voxels);
  }
  std::uint64_t pairs(std::size_t first, std::size_t end) const { return pairs_before[end] - pairs_before[first]; }
  std::uint64_t contents(std::size_t first, std::size_t end) const {
    return contents_before[end] - contents_before[first];
  }
  /// Returns the unit inside (first, end) that splits the contents into about equal halves.
  /// Range   At least two units.
  std::size_t middle(std::size_t first, std::size_t end) const {
    const auto at = contents_before.begin();
    const std::uint64_t half = contents_before[first] + contents(first, end) / 2;
    const auto found = std::lower_bound(at + std::ptrdiff_t(first) + 1, at + std::ptrdiff_t(end) - 1, half);
    return std::size_t(found - at);
  }
};

CellBake::CellBake(DeviceHeap& heap, const Tables& tables)
    : heap_(heap), tables_(tables), clock_(heap.stream()), host_(download_threads) {}

bool CellBake::bake(const DeviceInput& uploaded, const CellParameters& parameters, bool may_split, BakedCell& out) {
  out.window_min = parameters.window_min;
  out.max_error = parameters.max_error;
  const InputView input = uploaded.view();
  const bool has_triangles = input.triangle_count != 0;
  if (!has_triangles && parameters.edits == nullptr) return true;
  // Live bytes should stay within 1.2 times input and output. The output per triangle is estimated from the last cell.
  const double input_bytes = double(uploaded.bytes_with_textures()),
               output_bytes = output_per_triangle_ * double(input.triangle_count);
  Cell cell{input,
            window_of(parameters),
            parameters,
            uploaded.materials(),
            limit_of(parameters.memory_bytes, uploaded.bytes()),
            std::uint64_t((live_share - 1) * input_bytes + live_share * output_bytes)};
  heap_.limit_to(0);
  clock_.mark(0);
  DeviceArray<SnappedVertex> vertices;
  DeviceArray<SnapWindow> window;
  if (has_triangles && double(input.vertex_count) * sizeof(SnappedVertex) < 0.1 * (input_bytes + output_bytes)) {
    vertices = snap_vertices(heap_, cell.input, cell.window);
    cell.input.vertices = vertices.data();
  } else if (
      has_triangles) {  // keeping the vertices would take more than half of the spare 20 %, so each access snaps again
    window = DeviceArray<SnapWindow>(heap_, 1);
    const SnapWindow& snapped_to = cell.window;
    upload_async(window.data(), &snapped_to, sizeof snapped_to, heap_.stream(), "cudaMemcpyAsync (window)");
    cell.input.window = window.data();
  }
  clock_.mark(1);
  heap_.limit_to(cell.limit);
  const bool is_baked = bake_at_once(cell, out);
  if (!is_baked && may_split) bake_in_parts(cell, out);
  wait_for(heap_.stream(), "cudaStreamSynchronize (bake)");
  return is_baked || may_split;
}

/// Computes the levels [0, lods) of a range of bricks. Records the clock's marks 2 to 5.
LevelsAbove CellBake::levels_of(const Cell& cell, KeyRange range, int lods, BinCapacity& capacity, CellStats& stats) {
  clock_.mark(2);
  BrickLists lists;
  if (cell.input.triangle_count != 0) {
    const TraceSpan span("bin");
    lists = bin_triangles(heap_, cell.input, cell.window, range, capacity, stats);
  }
  clock_.mark(3);
  DeviceLevel finest;
  const TraceSpan span("voxelize and levels");
  if (lists.bricks != 0)
    finest = voxelize(heap_, cell.input, cell.room, cell.window, std::move(lists), cell.parameters, cell.materials,
                      fill_ratios_, stats);
  if (cell.parameters.edits != nullptr) edit_level(heap_, pinned_, *cell.parameters.edits, range, host_, finest);
  clock_.mark(4);
  LevelsAbove all;
  if (finest.bricks != 0) {
    all = coarser_levels(heap_, tables_, finest, lods, cell.parameters.mip, cell.parameters.normals);
    if (!cell.parameters.directional_coverage)
      for (DeviceLevel& level : all.levels) level.directional_coverage = DeviceArray<std::uint8_t>();
    all.levels.insert(all.levels.begin(), std::move(finest));
  }
  clock_.mark(5);
  return all;
}

void CellBake::count_batch(CellStats& total) const {
  wait_for(heap_.stream(), "cudaStreamSynchronize (levels)");
  total.batches += 1;
  total.snap_s = clock_.between(0, 1);
  total.sort_s += clock_.between(2, 3);
  total.voxelize_s += clock_.between(3, 4);
  total.mip_s += clock_.between(4, 5);
}

bool CellBake::bake_at_once(const Cell& cell, BakedCell& out) {
  try {
    CellStats stats;
    const int lods = cell.window.levels + 1;
    LevelsAbove all = levels_of(cell, all_keys(cell.window), lods, bin_capacity_, stats);
    DownsampleState above = source_of(all, lods - 1, cell.parameters.mip);
    std::vector<DeviceLevel> levels = std::move(all.levels);
    approximate_levels(heap_, tables_, cell.parameters.max_error, levels);
    DeviceNodes nodes;
    if (!levels.empty()) nodes = brick_nodes(heap_, levels);
    std::uint64_t bytes = 0;
    for (const DeviceLevel& level : levels) bytes += level.bytes();
    if (cell.parameters.edits == nullptr) output_per_triangle_ = double(bytes) / double(cell.input.triangle_count);
    clock_.mark(6);
    out.levels = std::move(levels);
    out.nodes = std::move(nodes);
    out.above = std::move(above);
    out.max_error = 0;
    count_batch(stats);
    stats.prune_s = clock_.between(5, 6);
    out.cell_stats = stats;
    return true;
  } catch (const DeviceFull&) {
    return false;
  }
}

/// Reads back the state from which the overviews above the cell are made.
DownsampleState CellBake::source_of(const LevelsAbove& all, int lod, MipFilter filter) {
  if (all.levels.empty()) return {};
  const std::size_t wanted = is_of_64(filter, lod + 1) ? 2 : 1;
  std::vector<Level> levels = to_host(heap_.stream(), pinned_, std::span(all.levels).last(wanted), {}, host_).levels;
  LevelSurface surface;
  append(all.rasters, surface.rasters);
  append(all.patches, surface.patches);
  return downsample_state(levels, lod, surface, filter);
}

/// Bakes the levels up to that of the units on the device, part by part. Computes the coarser levels, which are small,
/// on the host.
void CellBake::bake_in_parts(const Cell& cell, BakedCell& out) {
  Units units{std::clamp(cell.window.levels - levels_above_units, std::min(min_unit_level, cell.window.levels),
                         cell.window.levels)};
  heap_.limit_to(0);
  std::vector<std::uint64_t> pairs(std::size_t(1) << 3 * (cell.window.levels - units.level));
  if (cell.input.triangle_count != 0)
    pairs = pairs_by_unit(heap_, cell.input, cell.window, units.level, out.cell_stats);
  const LevelEdits* edits = cell.parameters.edits;
  for (std::uint64_t u = 0; u < pairs.size(); ++u)
    units.push_back(pairs[u],
                    edits == nullptr ? 0 : edits->filled_voxels(u << 3 * units.level, (u + 1) << 3 * units.level));
  bake_units(cell, units, 0, pairs.size(), out);
  if (out.host_levels.empty()) return;
  std::size_t lod = out.host_levels.size();
  add_coarser_levels(out.host_levels, out.host_surface, cell.window.levels + 1, cell.parameters.mip,
                     cell.parameters.normals, host_);
  out.above = downsample_state(out.host_levels, cell.window.levels, out.host_surface, cell.parameters.mip);
  if (!cell.parameters.directional_coverage) drop_directional_coverage(out.host_levels);
  for (; lod < out.host_levels.size(); ++lod)
    out.host_hashes.push_back(level_hash(out.host_levels[lod], int(lod), out.window_min, host_));
}

/// Bakes a range of units; splits it into halves if it does not fit.
void CellBake::bake_units(const Cell& cell, const Units& units, std::size_t first, std::size_t end, BakedCell& out) {
  if (units.contents(first, end) == 0 || bake_part(cell, units, first, end, out)) return;
  const std::size_t middle = units.middle(first, end);
  bake_units(cell, units, first, middle, out);
  bake_units(cell, units, middle, end, out);
}

/// Bakes the units [first, end) as one part. Returns false and changes nothing if the part does not fit the limit. A
/// single unit has no limit; DeviceFull is thrown if it does not fit the device.
bool CellBake::bake_part(const Cell& cell, const Units& units, std::size_t first, std::size_t end, BakedCell& out) {
  const bool is_min_size = end - first == 1;
  heap_.limit_to(is_min_size ? 0 : cell.limit);
  try {
    CellStats stats;
    BinCapacity capacity;
    capacity.pairs = std::max<std::uint64_t>(units.pairs(first, end), 1);
    const KeyRange keys{std::uint32_t(first << 3 * units.level), std::uint32_t(end << 3 * units.level)};
    const LevelsAbove part = levels_of(cell, keys, units.level + 1, capacity, stats);
    if (!part.levels.empty()) take_part(part, out);
    out.cell_stats.pairs += stats.pairs;
    out.cell_stats.fragments += stats.fragments;
    count_batch(out.cell_stats);
    return true;
  } catch (const DeviceFull&) {
    if (is_min_size) throw;
    return false;
  }
}

void CellBake::take_part(const LevelsAbove& device, BakedCell& out) {
  const std::vector<DeviceLevel>& levels = device.levels;
  const std::vector<Hash128> hashes = level_hashes(heap_, levels, out.window_min);
  const CellVolume part = to_host(heap_.stream(), pinned_, levels, DeviceNodes{}, host_);
  append(device.rasters, out.host_surface.rasters);
  append(device.patches, out.host_surface.patches);
  out.host_levels.resize(levels.size());
  out.host_hashes.resize(levels.size());
  for (std::size_t l = 0; l < levels.size(); ++l) {
    append(out.host_levels[l], part.levels[l]);
    out.host_hashes[l] += hashes[l];
  }
}

}  // namespace gigabake::kernels
