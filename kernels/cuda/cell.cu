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

/// The smallest units are the nodes `levels_above_units` levels below the root. They are at least `min_unit_level`
/// levels above the bricks, because a launch for a small unit is not worth its cost.
constexpr int levels_above_units = 5, min_unit_level = 2;
constexpr double unit_share = 0.25;  ///< max contents of a larger unit, as a multiple of the max contents that fitted
constexpr double live_share = 1.2;   ///< intended live bytes, as a multiple of the expected bytes of input and output
constexpr double growth_share = 1.125;  ///< capacity of the arrays of parts, as a multiple of the expected size
constexpr double max_growth = 8;        ///< max capacity of these arrays, as a multiple of the size
constexpr double retried_share = 1.5;   ///< max contents that are tried, as a multiple of the max contents that fitted

std::uint64_t limit_of(std::uint64_t memory_bytes, std::uint64_t input_bytes) {
  if (memory_bytes == 0) return 0;
  return std::max({memory_bytes - std::min(memory_bytes, input_bytes), memory_bytes / 4, std::uint64_t(1)});
}

/// Reserves capacity for `more` elements. An array that must grow gets capacity for the expected size of the cell, but
/// parts differ, so the estimate is bounded. `done` is the share of the cell, in (0, 1], that is baked with these
/// elements.
template <class T>
void reserve(std::vector<T>& array, std::uint64_t more, double done) {
  const std::uint64_t size = array.size() + more;
  if (size > array.capacity()) array.reserve(std::size_t(double(size) * std::min(growth_share / done, max_growth)));
}

void reserve(Level& to, const DeviceLevel& from, double done) {
  reserve(to.key, from.bricks, done);
  reserve(to.mask, 8 * std::uint64_t(from.bricks), done);
  reserve(to.first, std::uint64_t(from.bricks) + 1, done);
  reserve(to.rgba, 4 * std::uint64_t(from.voxels), done);
  if (!from.normal.empty()) reserve(to.normal, 2 * std::uint64_t(from.voxels), done);
  if (!from.directional_coverage.empty())
    reserve(to.directional_coverage, directional_coverage_bytes * std::uint64_t(from.voxels), done);
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
  bool is_min_size;                               ///< a unit cannot be split
  std::vector<std::uint64_t> pairs_before{0};     ///< of triangles and bricks
  std::vector<std::uint64_t> contents_before{0};  ///< pairs, and voxels that edits fill

  void push_back(std::uint64_t pairs, std::uint64_t filled_voxels) {
    pairs_before.push_back(pairs_before.back() + pairs);
    contents_before.push_back(contents_before.back() + pairs + filled_voxels);
  }
  std::size_t size() const { return pairs_before.size() - 1; }
  std::uint64_t contents() const { return contents_before.back(); }
  std::uint64_t max_contents() const {
    std::uint64_t max = 0;
    for (std::size_t u = 1; u < contents_before.size(); ++u) max = std::max(max, contents(u - 1, u));
    return max;
  }
  /// Returns units of eight of these units each.
  Units merged() const {
    Units out{level + 1, false};
    for (std::size_t u = 8; u < pairs_before.size(); u += 8) {
      out.pairs_before.push_back(pairs_before[u]);
      out.contents_before.push_back(contents_before[u]);
    }
    return out;
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

/// Returns the smallest units of a cell.
CellBake::Units CellBake::min_units(const Cell& cell, CellStats& stats) {
  const int levels = cell.window.levels;
  Units units{std::clamp(levels - levels_above_units, std::min(min_unit_level, levels), levels), true};
  std::vector<std::uint64_t> pairs(std::size_t(1) << 3 * (levels - units.level));
  if (cell.input.triangle_count != 0) pairs = pairs_by_unit(heap_, cell.input, cell.window, units.level, stats);
  const LevelEdits* edits = cell.parameters.edits;
  for (std::uint64_t u = 0; u < pairs.size(); ++u)
    units.push_back(pairs[u],
                    edits == nullptr ? 0 : edits->filled_voxels(u << 3 * units.level, (u + 1) << 3 * units.level));
  return units;
}

/// Bakes the levels up to that of the units on the device, part by part. Computes the coarser levels, which are small,
/// on the host. Larger units leave fewer levels to the host. They are used if parts of other cells show that they fit.
void CellBake::bake_in_parts(const Cell& cell, BakedCell& out) {
  heap_.limit_to(0);
  const Units min_size = min_units(cell, out.cell_stats);
  Units units = min_size;
  const double max_contents = unit_share * contents_per_byte_ * double(cell.limit);
  while (units.level < cell.window.levels) {
    Units larger = units.merged();
    if (double(larger.max_contents()) > max_contents) break;
    units = std::move(larger);
  }
  const CellStats stats = out.cell_stats;
  if (!bake_units(cell, units, 0, units.size(), out)) {
    contents_per_byte_ = 0;
    out.cell_stats = stats;
    out.host_levels = {};
    out.host_hashes = {};
    out.host_surface = {};
    bake_units(cell, min_size, 0, min_size.size(), out);
  }
  if (out.host_levels.empty()) return;
  std::size_t lod = out.host_levels.size();
  add_coarser_levels(out.host_levels, out.host_surface, cell.window.levels + 1, cell.parameters.mip,
                     cell.parameters.normals, host_);
  out.above = downsample_state(out.host_levels, cell.window.levels, out.host_surface, cell.parameters.mip);
  if (!cell.parameters.directional_coverage) drop_directional_coverage(out.host_levels);
  for (; lod < out.host_levels.size(); ++lod)
    out.host_hashes.push_back(level_hash(out.host_levels[lod], int(lod), out.window_min, host_));
}

/// Bakes a range of units; splits it into halves if it does not fit, or if no part of about its contents has fitted.
/// Returns false if a unit that can be split does not fit.
bool CellBake::bake_units(const Cell& cell, const Units& units, std::size_t first, std::size_t end, BakedCell& out) {
  const std::uint64_t contents = units.contents(first, end);
  if (contents == 0) return true;
  const double max_fitted = contents_per_byte_ * double(cell.limit);
  const bool may_fit = end - first == 1 || max_fitted == 0 || double(contents) <= retried_share * max_fitted;
  if (may_fit && bake_part(cell, units, first, end, out)) return true;
  if (end - first == 1) return false;
  const std::size_t middle = units.middle(first, end);
  return bake_units(cell, units, first, middle, out) && bake_units(cell, units, middle, end, out);
}

/// Bakes the units [first, end) as one part. Returns false and changes nothing if the part does not fit the limit. A
/// single unit of the smallest size has no limit; DeviceFull is thrown if it does not fit the device.
bool CellBake::bake_part(const Cell& cell, const Units& units, std::size_t first, std::size_t end, BakedCell& out) {
  const bool is_min_size = units.is_min_size && end - first == 1;
  heap_.limit_to(is_min_size ? 0 : cell.limit);
  try {
    CellStats stats;
    BinCapacity capacity;
    capacity.pairs = std::max<std::uint64_t>(units.pairs(first, end), 1);
    const KeyRange keys{std::uint32_t(first << 3 * units.level), std::uint32_t(end << 3 * units.level)};
    const LevelsAbove part = levels_of(cell, keys, units.level + 1, capacity, stats);
    if (!part.levels.empty()) take_part(part, double(units.contents(0, end)) / double(units.contents()), out);
    out.cell_stats.pairs += stats.pairs;
    out.cell_stats.fragments += stats.fragments;
    count_batch(out.cell_stats);
    if (!is_min_size && cell.limit != 0)
      contents_per_byte_ = std::max(contents_per_byte_, double(units.contents(first, end)) / double(cell.limit));
    return true;
  } catch (const DeviceFull&) {
    if (is_min_size) throw;
    return false;
  }
}

/// Appends a part to the levels on the host. `done` is the share of the cell that is baked with this part.
void CellBake::take_part(const LevelsAbove& part, double done, BakedCell& out) {
  const std::vector<Hash128> hashes = level_hashes(heap_, part.levels, out.window_min);
  out.host_levels.resize(part.levels.size());
  out.host_hashes.resize(part.levels.size());
  for (std::size_t l = 0; l < part.levels.size(); ++l) {
    reserve(out.host_levels[l], part.levels[l], done);
    out.host_hashes[l] += hashes[l];
  }
  append_to_host(heap_.stream(), pinned_, part.levels, host_, out.host_levels);
  append(part.rasters, out.host_surface.rasters);
  append(part.patches, out.host_surface.patches);
}

}  // namespace gigabake::kernels
